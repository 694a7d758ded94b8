"""What the contests came to: tables, and which goals are met."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from rich.table import Table

from tests.bench.any_hit_rays import ANY_HITS
from tests.bench.contest import LEAST_AGREEMENT, SECOND_CORE, Spread, thread_numbers
from tests.bench.embree import MODES
from tests.bench.frame_times import METHODS
from tests.bench.frames import ALL_RAYS, ASKED_RAYS, PathFrame
from tests.bench.views import KINDS, SINGLE, Contest

LEAST_RATIO = {"primary": 1.5, "shadow": 1.5, "mirror": 1.0, "incoherent": 1.1}  # median over views; of others 1
NEVER_BELOW = {"primary": 1.0, "shadow": 1.0}  # in any view
TWO_THREADS = 1.8


class Goal(NamedTuple):
    """What is to be at least `target`; `met` is None where the machine did not let it be judged."""

    scene: str
    what: str
    target: float
    value: float

    @property
    def met(self) -> bool | None:
        return None if np.isnan(self.value) else self.value >= self.target


def gains(one: Sequence[float], two: Sequence[float], second_core: Sequence[float]) -> list[float]:
    """What two threads gain on one, in those rounds beside which the second core was there."""
    return [a / b for a, b, core in zip(one, two, second_core) if core >= SECOND_CORE]


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if len(values) else float("nan")


def _of_kind(contests: list[Contest], kind: str) -> list[Contest]:
    return [contest for contest in contests if contest.kind == kind]


def _ratios(contests: list[Contest]) -> list[float]:
    return [contest.ratio().median for contest in contests]


def _gains(contests: list[Contest]) -> list[float]:
    return [gain for c in contests for gain in gains(c.ours, c.two, c.second_core)]


def ray_goals(scene: str, contests: list[Contest]) -> list[Goal]:
    made = []
    of = {kind: found for kind in KINDS + ANY_HITS if (found := _of_kind(contests, kind))}
    for kind, of_kind in of.items():
        opponent = "Embree's single-ray call" if kind == SINGLE else "Embree's best"
        what, ratios = f"{kind} rays, over {opponent}", _ratios(of_kind)
        made.append(Goal(scene, f"{what}: median of views", LEAST_RATIO.get(kind, 1.0), _median(ratios)))
        if kind in NEVER_BELOW:
            made.append(Goal(scene, f"{what}: worst view", NEVER_BELOW[kind], min(ratios)))
        if kind in ANY_HITS:
            gains_by_view = [_median(np.divide(contest.nearest, contest.ours).tolist()) for contest in of_kind]
            made.append(Goal(scene, f"{kind} rays, any hits over nearest hits", 1.0, _median(gains_by_view)))
    if len(thread_numbers()) > 1:
        made += [
            Goal(scene, f"{kind} rays, two threads over one", TWO_THREADS, _median(_gains(of[kind]))) for kind in of
        ]
    return made


def _kept_up(frames: list[PathFrame], threads: int) -> list[float]:
    return [frame.seconds["none"][threads] / frame.seconds["paper"][threads] for frame in frames]


def _frame_gains(frames: list[PathFrame], method: str) -> list[float]:
    seconds = [[frame.seconds[method].get(threads, np.nan) for frame in frames] for threads in (1, 2)]
    return gains(seconds[0], seconds[1], [frame.second_core for frame in frames])


def _beside(frames: list[PathFrame], method: str, traced: str, threads: int) -> list[float]:
    return [frame.ratio(method, traced, threads) for frame in frames if frame.embree]


COMPARED = (("none", ALL_RAYS), ("paper", ALL_RAYS), ("paper", ASKED_RAYS))


def frame_goals(scene: str, frames: list[PathFrame]) -> list[Goal]:
    made = []
    for threads in thread_numbers():
        name = f"frames, {_threads(threads)}"
        made.append(Goal(scene, f"{name}: none over paper", 1.0, _median(_kept_up(frames, threads))))
        for method, traced in COMPARED:
            if beside := _beside(frames, method, traced, threads):
                made.append(Goal(scene, f"{name}: {traced}, by Embree, over {method}", 1.0, _median(beside)))
    if len(thread_numbers()) > 1:
        for method in METHODS:
            gain = _median(_frame_gains(frames, method))
            made.append(Goal(scene, f"frames, {method}: two threads over one", TWO_THREADS, gain))
    return made


def _threads(number: int) -> str:
    return "1 thread" if number == 1 else f"{number} threads"


def _table(title: str, first: str, columns: Sequence[str], caption: str = "") -> Table:
    made = Table(title=title, title_justify="left", title_style="bold", caption=caption, caption_justify="left")
    made.add_column(first)
    for column in columns:
        made.add_column(column, justify="right")
    return made


def rays_table(scene: str, size: int, contests: list[Contest], kinds: Sequence[str] = KINDS) -> Table:
    views = len({contest.time for contest in contests})
    made = _table(
        f"{scene}: rays of {views} view{'s' if views > 1 else ''}, {size} x {size}, one thread",
        "million rays a second, median of views",
        kinds,
        "answers differ from robust Embree's: t by more than 1e-4 of itself, or another answer altogether; "
        "and by more than the offset at which rays leave a surface",
    )

    def row(name: str, cell: Callable[[list[Contest]], str]) -> None:
        made.add_row(name, *(cell(of_kind) if (of_kind := _of_kind(contests, kind)) else "" for kind in kinds))

    row("ours", lambda cs: f"{_median([c.rate(c.ours).median for c in cs]):.1f}")
    row("Embree's best", lambda cs: f"{_median([c.rate(c.embree).median for c in cs]):.1f}")
    row("  by, mostly", lambda cs: Counter(c.opponent for c in cs).most_common(1)[0][0])
    row("ours over Embree's, median of views", lambda cs: f"{_median(_ratios(cs)):.2f}")
    row("  worst and best view", lambda cs: f"{min(_ratios(cs)):.2f} to {max(_ratios(cs)):.2f}")
    row("two threads over one", lambda cs: Spread.of(_gains(cs)).text() if _gains(cs) else "no second core")
    row("rays", lambda cs: f"{sum(c.rays for c in cs):,}")
    row("answers that differ", lambda cs: f"{_share(cs, 'differing_strictly'):.4%}")
    row("  by more than the offset", lambda cs: f"{_share(cs, 'differing'):.4%}")
    row("Embree's own, robust off", lambda cs: f"{_share(cs, 'embree_differing'):.4%}")
    return made


def _share(contests: list[Contest], of: str) -> float:
    return sum(getattr(c, of) for c in contests) / sum(c.rays for c in contests)


def views_table(scene: str, contests: list[Contest], kinds: Sequence[str] = KINDS) -> Table:
    made = _table(f"{scene}: ours over Embree's, view by view", "time, s", kinds, "median of rounds (quartiles)")
    for time in dict.fromkeys(contest.time for contest in contests):
        of_view = {contest.kind: contest for contest in contests if contest.time == time}
        made.add_row(f"{time:.2f}", *(of_view[k].ratio().text() if k in of_view else "" for k in kinds))
    return made


def modes_table(scene: str, contests: list[Contest]) -> Table:
    made = _table(f"{scene}: Embree's modes", "million rays a second", KINDS, "best of a few runs, median of views")
    for mode in map(str, MODES):
        rates = [[c.heats[mode] for c in _of_kind(contests, kind)] for kind in KINDS]
        made.add_row(mode, *(f"{_median(of_kind):.1f}" if of_kind else "" for of_kind in rates))
    return made


def frames_table(scene: str, frames: list[PathFrame]) -> Table:
    beside = [frame.embree for frame in frames if frame.embree]
    made = _table(
        f"{scene}: {len(frames)} whole frames along the path, {len(beside)} of them beside Embree",
        "milliseconds a frame",
        [_threads(number) for number in thread_numbers()],
        "median (quartiles) of frames; Embree traces rays alone",
    )

    def row(name: str, values: Callable[[int], Sequence[float]], form: str) -> None:
        cells = [Spread.of(found).text(form) if len(found := values(t)) else "" for t in thread_numbers()]
        made.add_row(name, *cells)

    for method in METHODS:
        row(method, lambda threads, m=method: [1e3 * f.seconds[m][threads] for f in frames], ".1f")
    row("none over paper", lambda threads: _kept_up(frames, threads), ".3f")
    for traced in (ALL_RAYS, ASKED_RAYS):
        row(
            f"Embree, {traced}",
            lambda threads, traced=traced: [1e3 * float(np.median(e.seconds[traced][threads])) for e in beside],
            ".1f",
        )
    for method, traced in COMPARED:
        row(f"  {traced}, by Embree, over {method}", lambda t, m=method, r=traced: _beside(frames, m, r, t), ".2f")
    return made


def goals_table(goals: list[Goal]) -> Table:
    made = _table("Goals", "", ("at least", "here", ""), "no second core: two threads that only spin gained too little")
    verdicts = {True: "met", False: "[bold]missed[/bold]", None: "no second core"}
    for scene in dict.fromkeys(goal.scene for goal in goals):
        made.add_section()
        made.add_row(f"[bold]{scene}[/bold]", "", "", "")
        for goal in goals:
            if goal.scene == scene:
                here = "" if goal.met is None else f"{goal.value:.3f}"
                made.add_row(f"  {goal.what}", f"{goal.target:.2f}", here, verdicts[goal.met])
    return made


def faults(scene: str, contests: list[Contest], frames: list[PathFrame]) -> list[str]:
    """Everything for which the figures are not to be trusted."""
    found = []
    for kind in KINDS + ANY_HITS:
        of_kind = _of_kind(contests, kind)
        if of_kind and (share := 1 - _share(of_kind, "differing")) < LEAST_AGREEMENT:
            found.append(f"{scene}: only {share:.4%} of answers to {kind} rays are Embree's")
    for frame in frames:
        found += [f"{scene}, {frame.time:.2f} s: {fault}" for fault in frame.faults]
    return found


def to_json(goals: list[Goal]) -> list[dict[str, Any]]:
    """A value that could not be judged is None."""
    return [g._asdict() | {"value": None if g.met is None else g.value, "met": g.met} for g in goals]
