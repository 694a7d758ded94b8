"""The numbers of the newest frame, and the resolution they are for."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import imgui

from tracer.frame import Frame
from tracer.geometry.accelerators import BVH8
from tracer.method import Method
from tracer.statistics import FrameStatistics, RayCounts
from viewer.state import terms, verified
from viewer.util.numbers import whole_percent
from viewer.window.panels import coming
from viewer.window.ui import Ui
from viewer.window.widgets import (
    QUIET,
    amount,
    clipped,
    count,
    em,
    heading,
    paragraph,
    percent,
    right,
    short,
    tooltip,
)

_WIDE = 15.0  # ems of a panel that has room for counts and shares beside each other
_NAMES, _PART = 6.6, 3.6  # ems of the names there, and of the shares
_WORK = ("rays", "steps", "tests")


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    frame = c.frame
    if frame is None or c.traced is None:
        paragraph(coming.first_picture(c), QUIET)
        return
    s = frame.statistics
    pixels = max(round(s.part * frame.width * frame.height), 1)  # that have been shaded
    divisor = c.traced.request.divisor
    coarse = f", 1/{divisor} size" if divisor > 1 else ""
    part = f"{whole_percent(s.part)} of " if s.part < 1.0 else ""
    clipped(f"{part}{frame.width} x {frame.height} pixels{coarse}")
    tooltip("of the first sample of each pixel that is shaded; primary rays and proofs are those of all pixels")
    old = c.scheduler.outdated  # said in a line that is there anyway, so that nothing moves
    clipped(f"method {frame.settings.method}{', before the change' if old else ''}", QUIET if old else None)
    if old:
        tooltip("These are for the previous settings; a new frame is being traced.")
    certifies, prepares = Method.parse(frame.settings.method).has_certificates, terms.made(frame.settings.method)[0]
    _shadow_rays(frame, pixels, certifies)
    _verified(s)
    heading("Work")
    _work(ui)
    if s.built is not None:
        with _amounts("tree") as shown:
            tip = f"{terms.MEANINGS[terms.BUILT]} ({count(s.built.primitives)} of {count(s.built.of)})"
            if shown:
                amount("Tree built", percent(s.built.primitives, s.built.of), tip)
                size = f"in {s.built.memory_bytes / 1e6:.1f} MB, with what waits for rays"
                amount("  nodes", count(s.built.nodes), size)
    if terms.asks_by_beams(frame, c.scheduler.lamps.any):
        paragraph(terms.BY_BEAMS, QUIET)
    heading("Time")
    with _amounts("time") as shown:
        if shown:
            amount("Frame", _milliseconds(s.seconds), "from the request to the picture; below, its parts")
            for name in [*terms.PHASES, *(n for n in s.phases if n not in terms.PHASES)]:
                if name in s.phases and (prepares or name != "certification"):
                    label, tip = terms.phase(name, frame.settings)
                    amount(f"  {label}", _milliseconds(s.phases[name]), tip)
            amount("Window drawn in", _milliseconds(c.drawn_seconds), "what the window needs for one of its own frames")


def _shadow_rays(frame: Frame, pixels: int, certifies: bool) -> None:
    """What became of them, and what deciding that took."""
    s, shadow = frame.statistics, frame.statistics.shadow
    room = imgui.get_content_region_avail().x
    wide = room > em(_WIDE)
    fits = imgui.calc_text_size(count(shadow.due)).x < room - em(_NAMES + _PART + 0.6)
    number = count if wide and fits else short

    def fate(term: str, part: int, whole: int = shadow.due) -> None:
        name, tip, share = term.capitalize(), terms.MEANINGS[term], percent(part, whole)
        if wide:
            amount(name, number(part), f"{tip} ({count(part)})")
            imgui.table_next_column()
            right(share)
        else:
            amount(name, share, f"{tip} ({count(part)})")

    heading("Shadow rays")
    with _amounts("shadow" if wide else "shadow, narrow", em(_PART) if wide else 0.0) as shown:
        if not shown:
            return
        amount(terms.DUE.capitalize(), number(shadow.due), f"{terms.MEANINGS[terms.DUE]} ({count(shadow.due)})")
        fate(terms.SAVED, shadow.saved)
        fate(terms.CULLED, shadow.culled)
        fate(terms.DYNAMIC_ONLY, shadow.dynamic_only)
        if certifies or shadow.candidates_only:
            fate(terms.CANDIDATES_ONLY, shadow.candidates_only)
        if Method.parse(frame.settings.method).has("cache") or shadow.cache_hits:
            fate(terms.CACHE_HITS, shadow.cache_hits)
        fate(terms.TRACED, shadow.traced)
        if shadow.passed_over:
            tip = f"{terms.MEANINGS[terms.PASSED_OVER]} ({count(shadow.passed_over)})"
            amount(terms.PASSED_OVER.capitalize(), number(shadow.passed_over), tip)
    with _amounts("cost of deciding") as shown:
        if not shown:
            return
        amount("Due per pixel", f"{shadow.due / pixels:.2f}")
        if Method.parse(frame.settings.method).uses_modes:
            tip = f"whether a primitive hides that of the neighbouring pixel ({count(s.occlusion_tests)} in all)"
            amount("Occlusion tests per pixel", f"{s.occlusion_tests / (frame.width * frame.height):.3f}", tip)
        made, meaning = terms.made(frame.settings.method)
        if made:
            amount(made.capitalize(), count(s.certificates), meaning, wraps=True)


def _verified(s: FrameStatistics) -> None:
    """What is wrong, of the rays due in all samples, while the rows above are of the first."""
    found = s.wrong
    if found is None:
        return
    heading(verified.named("Verified", found))
    with _amounts("verified", em(_PART)) as shown:
        if not shown:
            return

        def wrong(term: str, part: int, whole: int) -> None:
            amount(term.capitalize(), count(part), f"{terms.MEANINGS[term]} ({percent(part, whole)} of {count(whole)})")
            imgui.table_next_column()
            right(percent(part, whole))

        if s.cuts is not None:
            wrong(terms.BEYOND, found.pixels, found.shaded)
            return
        amount(terms.DUE.capitalize(), short(found.due), f"{terms.MEANINGS[terms.DUE]} ({count(found.due)})")
        wrong(terms.WRONG, found.answers, found.due)
        wrong(terms.WRONG_PIXELS, found.pixels, found.shaded)


@contextmanager
def _amounts(name: str, shares: float = 0.0) -> Iterator[bool]:
    """A table of names and numbers, and a column of shares where that has a width."""
    shown = imgui.begin_table(name, 3 if shares else 2, int(imgui.TableFlags_.sizing_stretch_prop))
    if shown:
        if shares:
            imgui.table_setup_column("name", int(imgui.TableColumnFlags_.width_fixed), em(_NAMES))
        else:
            imgui.table_setup_column("name", int(imgui.TableColumnFlags_.width_stretch), 2.4)
        imgui.table_setup_column("number", int(imgui.TableColumnFlags_.width_stretch), 1.0)
        if shares:
            imgui.table_setup_column("share", int(imgui.TableColumnFlags_.width_fixed), shares)
    try:
        yield shown
    finally:
        if shown:
            imgui.end_table()


def _milliseconds(seconds: float) -> str:
    return f"{1e3 * seconds:.1f} ms"


def _work(ui: Ui) -> None:
    """Rays, steps and tests of each kind of ray, and those of what the method makes."""
    frame = ui.controller.frame
    assert frame is not None
    s = frame.statistics
    shaded = f", at the {percent(s.part, 1.0)} of the pixels that is shaded" if s.part < 1.0 else ""
    rows: list[_Row] = [
        _row("primary", s.primary, s.primary.rays, "from the camera, through all pixels"),
        _row("secondary", s.secondary, s.secondary.rays, f"reflected and refracted{shaded}"),
        _row("shadow", s.shadow, s.shadow.traced, f"{terms.traced_shadow_rays(s.shadow)}{shaded}"),
    ]
    made, meaning = terms.made(frame.settings.method)
    if made:
        rows.append((terms.things(made), (0, s.certificate_steps, s.certificate_tests), meaning))
    rows.append(("all", tuple(sum(numbers[n] for _, numbers, _ in rows) for n in range(3)), terms.ALL_RAYS))
    means = "Steps: nodes of the tree that rays enter; tests: rays against primitives"
    if frame.settings.accelerator == BVH8:
        means += "; bvh8 counts one for a whole packet of up to 128 coherent rays (an experiment counts each ray's, in "
        means += "a kd-tree)"
    means += "."
    if imgui.get_content_region_avail().x > em(_WIDE):
        _work_table(rows, means)
        return
    with _amounts("work, narrow") as shown:  # a narrow panel has no room for four columns
        for name, numbers, tip in rows if shown else ():
            for title, number in zip(_WORK, numbers, strict=True):
                if number:
                    amount(f"{name}, {title}", short(number), f"{count(number)}: {tip}\n{means}")


_Row = tuple[str, tuple[int, ...], str]  # a kind of rays: its name, its rays, steps and tests, and which they are


def _row(name: str, counted: RayCounts, rays: int, tip: str) -> _Row:
    return name, (rays, counted.traversal_steps, counted.intersection_tests), tip


def _work_table(rows: list[_Row], means: str) -> None:
    if not imgui.begin_table("work", 4, int(imgui.TableFlags_.sizing_stretch_prop | imgui.TableFlags_.row_bg)):
        return
    imgui.table_setup_column("kind", int(imgui.TableColumnFlags_.width_fixed), em(5.2))
    for title in _WORK:
        imgui.table_setup_column(title, int(imgui.TableColumnFlags_.width_stretch))
    for title in ("", *_WORK):
        imgui.table_next_column()
        right(title, QUIET)
        tooltip(means)
    for name, numbers, tip in rows:
        imgui.table_next_column()
        paragraph(name, QUIET)
        tooltip(f"{tip}\n{means}")
        for number in numbers:
            imgui.table_next_column()
            right(short(number))
            tooltip(f"{count(number)}: {tip}\n{means}")
    imgui.end_table()
