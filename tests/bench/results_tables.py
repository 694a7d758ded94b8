"""Tables of the documentation from the figures that benchmarks write: JSON goes in, Markdown comes out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

Figures = dict[str, Any]  # what a benchmark wrote

# Table 1 of the paper: steps and tests saved on average and at most, extra tests per pixel.
PAPER = {
    "kitchen": ("−19.8 % (−59.5 %)", "−24.5 % (−59.8 %)", "0.173"),
    "robot": ("−7.4 % (−19.5 %)", "−9.5 % (−29.6 %)", "0.149"),
}
NAMES = {"kitchen": "Kitchen", "robot": "Robot", "museum": "Museum", "museum5": "Museum"}
REFERENCE, CULLING = "none", "paper"
KINDS = {
    "primary": "primary",
    "shadow": "shadow, from the light",
    "mirror": "mirror",
    "incoherent": "incoherent",
    "hemisphere": "any hits, over the hemisphere",
    "random order": "any hits of one light, in random order",
    "left at 0": "any hits left by culling, at primary hits",
    "left at 1": "…, at the first bounce",
    "left at 2": "…, at the second bounce",
}


def markdown(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table whose first column is to the left and whose others are to the right."""
    lines = [f"| {' | '.join(headings)} |", "|---" + "|---:" * (len(headings) - 1) + "|"]
    return "\n".join([*lines, *(f"| {' | '.join(row)} |" for row in rows)]) + "\n"


def scene_name(path: str) -> str:
    stem = Path(path).stem.lower()
    return NAMES.get(stem, f"{stem} scene")


def saved(run: Figures, method: str, work: str) -> np.ndarray:
    """(frames,) the part of the work of `none` that a method saves in each frame, its certificates counted against
    it; `work` is "steps" or "tests"."""
    name = {"steps": "shadow_traversal_steps", "tests": "shadow_intersection_tests"}[work]
    ours, none = run["methods"][method], run["methods"][REFERENCE]
    total = np.add(ours[name], ours[f"certificate_{work}"])
    return 1 - total / np.maximum(1, none[name])


def _percent(value: float) -> str:
    return f"{'−' if value >= 0 else '+'}{abs(value):.1%}".replace("%", " %")


def _wrong(run: Figures, method: str) -> str:
    """How many answers were wrong, of how many."""
    wrong, due = (sum(run["methods"][m][name]) for m, name in ((method, "wrong"), (REFERENCE, "shadow_rays_due")))
    of = f"of {due / 1e6:,.0f} million"
    return f"{wrong:,} {of} ({wrong / due:.3%})".replace("%", " %") if wrong else f"none {of}"


def _saving(run: Figures, method: str) -> tuple[str, str]:
    """Steps and tests saved: the average, and the most that any frame saves."""
    of = (saved(run, method, work) for work in ("steps", "tests"))
    steps, tests = (f"{_percent(values.mean())} ({_percent(values.max())})" for values in of)
    return steps, tests


def table_1(runs: dict[str, Figures]) -> str:
    """Table 1 beside the paper's, of scene → the figures of `bench`."""
    rows = []
    for scene, run in runs.items():
        extra = sum(run["methods"][CULLING]["occlusion_tests"]) / (len(run["frames"]) * run["size"][0] * run["size"][1])
        name = f"BART {NAMES[scene]}"
        rows.append((f"{name}, here", *_saving(run, CULLING), f"{extra:.3f}", _wrong(run, CULLING)))
        rows.append((f"{name}, paper", *PAPER[scene], "none, according to the paper"))
    headings = ("", "traversal steps", "intersection tests", "extra tests per pixel", "wrong answers")
    return markdown(headings, rows)


def one_tree(apart: dict[str, Figures], together: dict[str, Figures]) -> str:
    """Table 1 with trees apart and with one tree."""
    rows = []
    for scene in apart:
        name = f"BART {NAMES[scene]}"
        rows.append((f"{name}, trees apart", *_saving(apart[scene], CULLING)))
        rows.append((f"{name}, one tree with flags", *_saving(together[scene], CULLING)))
        rows.append((f"{name}, paper", *PAPER[scene][:2]))
    return markdown(("", "traversal steps", "intersection tests"), rows)


def _in_short(run: Figures, method: str) -> str:
    steps, tests = (_percent(float(saved(run, method, work).mean())) for work in ("steps", "tests"))
    wrong = sum(run["methods"][method]["wrong"])
    return f"{steps}, {tests}; {f'{wrong:,}' if wrong else 'none'}"


def all_methods(runs: dict[str, Figures]) -> str:
    """What each method saves on average, and its wrong answers."""
    rows = []
    for method in next(iter(runs.values()))["methods"]:
        if method != REFERENCE:
            rows.append((f"`{method}`", *(_in_short(run, method) for run in runs.values())))
    return markdown(("steps, tests; wrong answers", *(NAMES[scene] for scene in runs)), rows)


def times(runs: Sequence[Figures]) -> str:
    """How much of the time of `none` each method takes, of runs of `make quickest`."""
    rows = []
    for run in runs:
        for of in run["scenes"]:
            median = 1e3 * float(np.median(of["seconds"][REFERENCE]))
            figures = (f"{of[name]:.2f}" for name in ("total", "best", "worst"))
            about = scene_name(of["scene"]), of["accelerator"], f"`{of['method']}`", str(len(of["frames"]))
            rows.append((*about, f"{median:.0f}", *figures, f"{of['processor']['total']:.2f}"))
    headings = (
        "scene",
        "structure",
        "method",
        "frames",
        "`none`, ms",
        "all frames",
        "best 50",
        "worst 50",
        "processor",
    )
    return markdown(headings, rows)


def _spread(values: Sequence[float], form: str = ".2f") -> str:
    return f"{np.median(values):{form}} ({min(values):{form}} to {max(values):{form}})"


def rays(run: Figures) -> str:
    """Ray rates beside Embree's, of `make bench`: medians of views."""
    headings = ["million rays per second"]
    for scene in run["scenes"]:
        views = len({contest["time"] for contest in scene["rays"]})
        headings += [f"{scene_name(scene['scene'])}, {views} view{'s' if views > 1 else ''}", "Embree", "ratio"]
    rows = []
    for kind, name in KINDS.items():
        row = [name]
        for scene in run["scenes"]:
            of = [contest for contest in scene["rays"] if contest["kind"] == kind]
            rates = (np.median([c[f"{who}_million_rays"]["median"] for c in of]) for who in ("ours", "embree"))
            row += [*(f"{rate:.1f}" for rate in rates), _spread([c["ratio"]["median"] for c in of])]
        rows.append(row)
    return markdown(headings, rows)


def frames(run: Figures) -> str:
    """Whole frames, and Embree's time for their rays over ours, of `make bench`."""
    headings, columns = ["milliseconds per frame, median (quartiles)"], []
    for scene in run["scenes"]:
        for threads in sorted(scene["frames"][0]["seconds"][REFERENCE], key=int):
            columns.append((scene["frames"], threads))
            headings.append(f"{scene_name(scene['scene'])}, {threads} thread{'s' if int(threads) > 1 else ''}")

    def milliseconds(of: list[Figures], method: str, threads: str) -> str:
        low, median, high = np.percentile([1e3 * f["seconds"][method][threads] for f in of], (25, 50, 75))
        return f"{median:.0f} ({low:.0f} to {high:.0f})"

    def kept_up(of: list[Figures], threads: str) -> str:
        ratios = [f["seconds"][REFERENCE][threads] / f["seconds"][CULLING][threads] for f in of]
        return f"{np.median(ratios):.2f}"

    def beside(of: list[Figures], threads: str) -> str:
        found = [
            np.median(f["embree"]["seconds"]["all rays"][threads]) / f["seconds"][REFERENCE][threads]
            for f in of
            if f["embree"]
        ]
        return f"{np.median(found):.2f}" if found else ""

    rows = [[f"`{method}`", *(milliseconds(of, method, t) for of, t in columns)] for method in (REFERENCE, CULLING)]
    rows.append(["`none` over `paper`, frame by frame", *(kept_up(of, t) for of, t in columns)])
    rows.append(["Embree, tracing alone, over `none`", *(beside(of, t) for of, t in columns)])
    return markdown(headings, rows)


def lamps(run: Figures) -> str:
    """Speed of a method over that of `none` where lights are lamps, of `make lamps`."""
    rows = []
    for of in run["runs"]:
        ((method, known),) = of["known"].items()
        found, free = of["speed_up"][method], of["speed_up"]["free"]
        rows.append(
            (
                f"{scene_name(of['scene'])}, {100 * of['lamp_radius']:g} cm",
                f"{1e3 * float(np.median(of['seconds'][REFERENCE])):,.0f}",
                f"{found['total']:.2f} ({found['low']:.2f} to {found['high']:.2f})",
                f"{known:.0%}".replace("%", " %"),
                f"{free['total']:.2f}",
            )
        )
    return markdown(("lamps", "`none`, ms", "`certified` (quartiles)", "rays answered", "`free`"), rows)


def motion(run: Figures) -> str:
    """The window in motion, of `make motion`."""
    rows = []
    for scene, of in run["scenes"].items():
        for way, name in (("", f"{NAMES.get(scene, 'default scene')}"), ("baseline_", "… with the resolution divided")):
            ssim = f"{of[way + 'ssim_median']:.3f} ({of[way + 'ssim_p5']:.3f})"
            saved, whole = of[way + "saved"], of[way + "saved_whole"]
            wrong = f"{of[way + 'wrong']:.3%} ({of[way + 'wrong_whole']:.3%})"
            culled = f"{saved:.1%} ({saved / max(whole, 1e-9):.0%})", wrong
            rows.append((name, ssim, f"{of[way + 'frames_per_second']:.1f}", f"{of[way + 'settle']:.2f}", *culled))
    headings = ("in motion", "SSIM (5th percentile)", "frames per second", "sharp again after",
                "shadow rays saved (of what whole frames save)", "wrong answers (of whole frames)")  # fmt: skip
    return markdown(headings, rows)
