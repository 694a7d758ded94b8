"""The numbers of the newest frame, and the resolution they are for."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from imgui_bundle import imgui

from tracer.frame import Frame
from tracer.geometry.accelerators import BVH8
from tracer.method import Method
from tracer.statistics import FrameStatistics
from viewer.state import terms, verified
from viewer.util.numbers import whole_percent
from viewer.window.panels import status
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, count, em, heading, paragraph, percent, right, short, tooltip

_SHARE_WIDTH = 3.6  # ems
_SHORT_OF_ROOM = 12.0  # ems of a panel below which numbers give way to shares
_WORK_COLUMNS = ("rays", "steps", "tests")


class Row(NamedTuple):
    """A row of a table: its name, what is meant, a number or text, and the whole that the number is a part of."""

    name: str
    tip: str
    value: int | str
    whole: int | None = None


def show(ui: Ui) -> None:
    """Draw the panel."""
    c = ui.controller
    frame = c.frame
    if frame is None or c.traced is None:
        paragraph(status.first_picture(c), QUIET)
        return
    s = frame.statistics
    divisor = c.traced.request.divisor
    coarse = f", 1/{divisor} size" if divisor > 1 else ""
    part = f"{whole_percent(s.part)} of " if s.part < 1.0 else ""
    clipped(f"{part}{frame.width} x {frame.height} pixels{coarse}")
    tooltip("Of the first sample of each pixel that is shaded; primary rays and proofs are those of all pixels.")
    old = c.scheduler.outdated  # said in a line that is there anyway, so that nothing moves
    clipped(f"method {frame.settings.method}{', before the change' if old else ''}", QUIET if old else None)
    if old:
        tooltip("These are for the previous settings; a new frame is being traced.")
    heading("Shadow rays")
    _table("shadow", _shadow_rays(frame))
    _table("cost of culling", _cost_of_culling(frame))
    if s.wrong is not None:
        heading(verified.named("Verified", s.wrong))
        _table("verified", _verified(s))
    heading("Work")
    _work(frame)
    if s.built is not None:
        _table("tree", _tree(s))
    if terms.asks_by_beams(frame, c.scheduler.lamps.any):
        paragraph(terms.BY_BEAMS, QUIET)
    heading("Time")
    drawn = Row("Window drawn in", "What the window needs for one of its own frames.", _milliseconds(c.drawn_seconds))
    _table("time", [*_times(frame), drawn])


def _shadow_rays(frame: Frame) -> Iterator[Row]:
    """What became of the shadow rays."""
    shadow, method = frame.statistics.shadow, Method.parse(frame.settings.method)
    rows = [(terms.SAVED, shadow.saved), (terms.CULLED, shadow.culled), (terms.DYNAMIC_ONLY, shadow.dynamic_only)]
    if method.has_certificates or shadow.candidates_only:
        rows.append((terms.CANDIDATES_ONLY, shadow.candidates_only))
    if method.has("cache") or shadow.cache_hits:
        rows.append((terms.CACHE_HITS, shadow.cache_hits))
    rows.append((terms.TRACED, shadow.traced))
    yield _term(terms.DUE, shadow.due)
    yield from (_term(term, number, shadow.due) for term, number in rows)
    if shadow.passed_over:
        yield _term(terms.PASSED_OVER, shadow.passed_over)


def _cost_of_culling(frame: Frame) -> Iterator[Row]:
    s = frame.statistics
    shaded = max(round(s.part * frame.width * frame.height), 1)
    yield Row("Due per pixel", "", f"{s.shadow.due / shaded:.2f}")
    if Method.parse(frame.settings.method).uses_modes:
        tip = f"whether a primitive hides that of the neighbouring pixel ({count(s.occlusion_tests)} in all)"
        yield Row("Occlusion tests per pixel", tip, f"{s.occlusion_tests / (frame.width * frame.height):.3f}")
    made, meaning = terms.made(frame.settings.method)
    if made:
        yield Row(made.capitalize(), meaning, s.certificates)


def _verified(s: FrameStatistics) -> Iterator[Row]:
    """What is wrong, of the rays due in all samples, while the rows above are of the first."""
    found = verified.known(s.wrong)
    if s.cuts is not None:
        yield _term(terms.BEYOND, found.pixels, found.shaded)
        return
    yield _term(terms.DUE, found.due)
    yield _term(terms.WRONG, found.answers, found.due)
    yield _term(terms.WRONG_PIXELS, found.pixels, found.shaded)


def _tree(s: FrameStatistics) -> Iterator[Row]:
    assert s.built is not None
    yield _term(terms.BUILT, s.built.primitives, s.built.of)
    yield Row("  nodes", f"in {s.built.memory_bytes / 1e6:.1f} MB, with what waits for rays", s.built.nodes)


def _times(frame: Frame) -> Iterator[Row]:
    phases, prepares = frame.statistics.phases, terms.made(frame.settings.method)[0]
    yield Row("Frame", "From the request to the picture; below, its parts.", _milliseconds(frame.statistics.seconds))
    for name in [*terms.PHASES, *(n for n in phases if n not in terms.PHASES)]:
        if name in phases and (prepares or name != "certification"):
            label, tip = terms.phase(name, frame.settings)
            yield Row(f"  {label}", tip, _milliseconds(phases[name]))


def _term(term: str, number: int, whole: int | None = None) -> Row:
    return Row(term.capitalize(), terms.MEANINGS[term], number, whole)


def _milliseconds(seconds: float) -> str:
    return f"{1e3 * seconds:.1f} ms"


def _table(name: str, rows: Iterator[Row] | list[Row]) -> None:
    """Draw names, numbers at the right edge, and shares where any number has a whole."""
    rows = list(rows)
    shares = any(row.whole is not None for row in rows)
    narrow = shares and imgui.get_content_region_avail().x < em(_SHORT_OF_ROOM)
    if not imgui.begin_table(name, 3 if shares and not narrow else 2, int(imgui.TableFlags_.sizing_stretch_prop)):
        return
    imgui.table_setup_column("name", int(imgui.TableColumnFlags_.width_stretch), 2.0)
    imgui.table_setup_column("number", int(imgui.TableColumnFlags_.width_stretch), 1.0)
    if shares and not narrow:
        imgui.table_setup_column("share", int(imgui.TableColumnFlags_.width_fixed), em(_SHARE_WIDTH))
    for row in rows:
        text = row.value if isinstance(row.value, str) else short(row.value)
        share = percent(int(row.value), row.whole) if row.whole is not None else ""
        exact = "" if isinstance(row.value, str) else count(row.value)
        of = f"{exact} of {count(row.whole)} ({share})" if row.whole is not None else exact
        imgui.table_next_row()
        imgui.table_next_column()
        clipped(row.name)
        tooltip("\n".join(filter(None, (row.tip, of))))
        imgui.table_next_column()
        right(share if narrow and share else text)
        if shares and not narrow:
            imgui.table_next_column()
            right(share)
    imgui.end_table()


def _work(frame: Frame) -> None:
    """Draw rays, steps and tests of each kind of ray, and those of what the method makes."""
    s = frame.statistics
    shaded = f", at the {percent(s.part, 1.0)} of the pixels that is shaded" if s.part < 1.0 else ""
    kinds = (
        ("primary", s.primary, s.primary.rays, "from the camera, through all pixels"),
        ("secondary", s.secondary, s.secondary.rays, f"reflected and refracted{shaded}"),
        ("shadow", s.shadow, s.shadow.traced, f"{terms.traced_shadow_rays(s.shadow)}{shaded}"),
    )
    rows = [(name, (n, rays.traversal_steps, rays.intersection_tests), tip) for name, rays, n, tip in kinds]
    made, meaning = terms.made(frame.settings.method)
    if made:
        rows.append((terms.things(made), (0, s.certificate_steps, s.certificate_tests), meaning))
    rays, steps, tests = (sum(numbers[n] for _, numbers, _ in rows) for n in range(3))
    rows.append(("all", (rays, steps, tests), terms.ALL_RAYS))
    means = "Steps: nodes of the tree that rays enter; tests: rays against primitives"
    if frame.settings.accelerator == BVH8:
        means += "; bvh8 counts one for a whole packet of up to 128 coherent rays (an experiment counts each ray's, in "
        means += "a kd-tree)"
    if not imgui.begin_table("work", 4, int(imgui.TableFlags_.sizing_stretch_prop | imgui.TableFlags_.row_bg)):
        return
    imgui.table_setup_column("kind", int(imgui.TableColumnFlags_.width_stretch), 1.2)
    for title in _WORK_COLUMNS:
        imgui.table_setup_column(title, int(imgui.TableColumnFlags_.width_stretch), 1.0)
    for title in ("", *_WORK_COLUMNS):
        imgui.table_next_column()
        right(title, QUIET)
        tooltip(f"{means}.")
    for name, numbers, tip in rows:
        imgui.table_next_column()
        clipped(name, QUIET)
        tooltip(f"{tip}\n{means}.")
        for number in numbers:
            imgui.table_next_column()
            right(short(number))
            tooltip(f"{count(number)}: {tip}\n{means}.")
    imgui.end_table()
