"""The colours of views mean what their legends say, and the window shows the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.viewer.drawn import legend_in, options, picture, values_in, words_in
from tests.viewer.fakes import in_cells, in_part
from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode
from tracer.frame import Frame
from viewer import views
from viewer.state.draw_options import Slice
from viewer.state.palette import BACKGROUND, BENEATH, FATES, GREY, color_map
from viewer.state.views import Record, View
from viewer.util.numbers import percent
from viewer.views import colorize
from viewer.views.paint import CELL_LINE, FAINT_LINE, in_bytes
from viewer.views.voxels import STATES, voxels_of, voxels_seen

CLASSES = (View.OCCLUSION, View.SHADOW, View.CERTIFICATE, View.FATE, View.MOVING_SHADOW, View.PENUMBRA)
MAP = np.round(color_map() * 255).astype(int)


def on_lines(cells: NDArray) -> NDArray[np.bool_]:
    """Where the neighbour to the right or below is of another cell."""
    padded = np.pad(cells, ((0, 1), (0, 1)), mode="edge")
    found: NDArray[np.bool_] = (padded[:-1, 1:] != cells) | (padded[1:, :-1] != cells)
    return found


def classes_of(f: Frame, view: View, light: int) -> dict[str, NDArray[np.bool_]]:
    """Where each class is, by its name."""
    occlusion, shadow = f.occlusion_mode, f.shadow_mode[..., light]
    moves, whole = occlusion == OcclusionMode.DYNAMIC, occlusion == OcclusionMode.FULLY_RENDERED
    if view is View.OCCLUSION:
        return {mode.name.lower().replace("_", " "): occlusion == mode for mode in OcclusionMode}
    if view is View.SHADOW:
        culls = {f"{name}{after}": (shadow == mode) & ~moves & (whole == sure)
                 for mode, name in ((1, "full shadow"), (2, "non-shadow"))
                 for sure, after in ((True, ""), (False, ", untrusted"))}  # fmt: skip
        return culls | {"init": (shadow == 0) & ~moves, "partial shadow": (shadow == 3) & ~moves, "dynamic": moves}
    if view is View.CERTIFICATE:
        proved = (f.certificates >> (2 + 2 * light)) & 3
        names = enumerate(("none", "full", "lit", "candidates"))
        return {name: (proved == number) & ~moves for number, name in names} | {"dynamic": moves}
    if view is View.FATE:
        return {one.name: f.fate(light) == fate for fate, one in FATES.items()}
    if view is View.MOVING_SHADOW:
        dark, asked = f.moving_shadow(light), f.fate(light) == Fate.DYNAMIC_ONLY
        lit = asked & ~dark & ~moves
        return {"dynamic only, darkened": dark & asked, "darkened, but not dynamic only": dark & ~asked,
                "dynamic only, lit": lit, "moving object": moves & ~dark}  # fmt: skip
    asked, reached = (samples[..., light].astype(int) for samples in (f.asked, f.reached))
    known = np.ones(asked.shape, np.bool_) if f.shaded is None else f.shaded
    return {"fully lit": known & (asked > 0) & (reached == asked),
            "penumbra, more than half": known & (2 * reached > asked) & (reached < asked),
            "penumbra, at most half": known & (2 * reached <= asked) & (reached > 0),
            "fully dark": known & (asked > 0) & (reached == 0), "faces away": known & (asked == 0),
            "not known yet": ~known}  # fmt: skip


@pytest.mark.parametrize("view", CLASSES)
@pytest.mark.parametrize("light", [0, 1])
@pytest.mark.parametrize("of", [lambda frame: frame, in_part, in_cells], ids=["whole", "in part", "in cells"])
def test_classes_have_the_colours_the_shares_and_the_words_of_their_legend(frame: Frame, view: View, light: int, of):
    if of is in_cells and view not in (View.OCCLUSION, View.SHADOW):
        return
    f = of(replace(frame, certificates=None) if of is in_cells else frame)
    drawn, hit = picture(f, view, light, shading=0.0), f.primitive >= 0
    legend, values = legend_in(f, view, light), values_in(f, view, light)
    entries, seen = {entry.name: entry for entry in legend.entries}, 0
    y, x = np.indices(hit.shape)
    lines = on_lines(f.cell) if view is View.CERTIFICATE else np.zeros_like(hit)
    for name, mask in classes_of(f, view, light).items():
        there = mask & hit
        entry = entries.get(name)
        assert (entry is None and not there.any()) or entry.values[0] == percent(there.sum(), hit.sum()), name
        if not there.any():
            continue
        seen += 1
        row, column = np.argwhere(there)[0]
        if view is not View.PENUMBRA:
            assert len(np.unique(values.numbers[there])) == 1
            said = words_in(f, view, light, int(column), int(row))
            assert "".join(said).replace(" ", "") == name.replace(", ", "").replace(": ", "").replace(" ", "")
        elif name.startswith("penumbra"):
            continue
        color = np.broadcast_to(np.asarray(entry.color, np.float32), (*hit.shape, 3)).copy()
        if entry.stripes is not None:
            color[(x + y) // 3 % 2 == 1] = entry.stripes
        color[lines] *= np.float32(CELL_LINE)
        assert (drawn[there] == in_bytes(color)[there]).all(), name
    assert seen >= (2 if of is in_cells else 3)
    assert sum(entry.values[0] != "" for entry in legend.entries if entry.color) == len(entries) - (
        "dynamic, at rest" in entries
    )


@pytest.mark.parametrize("light", [0, 1])
def test_penumbrae_are_a_ramp_between_dark_and_lit(frame: Frame, light: int) -> None:
    drawn, hit = picture(frame, View.PENUMBRA, light, shading=0.0), frame.primitive >= 0
    asked, reached = frame.asked[..., light].astype(int), frame.reached[..., light].astype(int)
    between = hit & (reached > 0) & (reached < asked)
    assert between.any() == (light == 0), "a point has no penumbra"
    colors = {entry.name: np.asarray(entry.color) for entry in legend_in(frame, View.PENUMBRA, light).entries}
    few, most = colors["penumbra, at most half"], colors["penumbra, more than half"]
    share = (reached[between] / asked[between])[:, None]
    assert np.abs(drawn[between] - 255.0 * (few + share * (most - few))).max(initial=0) <= 1


def test_colours_are_clamped_and_otherwise_untouched(frame: Frame) -> None:
    np.testing.assert_array_equal(picture(frame), np.round(np.clip(frame.color, 0, 1) * 255).astype(np.uint8))


@pytest.mark.parametrize("view", [v for v in View if v is not View.COLOR and v.records is not Record.VERIFY])
def test_what_is_missed_has_the_background(frame: Frame, view: View) -> None:
    missed = frame.primitive < 0
    if view.has_slice:  # it is seen before the background, too
        missed &= ~values_in(frame, view).known
    assert missed.any() and (picture(frame, view)[missed] == in_bytes(BACKGROUND)).all()


def test_every_primitive_has_a_colour_of_its_own(frame: Frame) -> None:
    hit = frame.primitive >= 0
    colors = {tuple(c) for c in picture(frame, View.PRIMITIVE, shading=0.0)[hit]}
    assert len(colors) == len(np.unique(frame.primitive[hit]))


def test_a_light_past_the_culled_ones_is_drawn_as_unknown(frame: Frame) -> None:
    drawn = picture(replace(frame, lights=40), View.SHADOW, 35, shading=0.0)
    still = (frame.primitive >= 0) & (frame.occlusion_mode != OcclusionMode.DYNAMIC)
    assert (drawn[still] == in_bytes(GREY)).all()


@pytest.mark.parametrize("view", [View.SAVED, View.COST])
def test_work_is_mapped_up_to_nearly_the_most_and_shares_from_none_to_all(frame: Frame, view: View) -> None:
    work, whole = (frame.saved, frame.due_rays) if view is View.SAVED else (frame.cost, frame.saved + frame.cost)
    hit, top = frame.primitive >= 0, view.declared.span(frame)[1]
    assert np.mean(work[hit] > top) <= 0.01 and (work[hit] >= 0.9 * top).any()
    due = hit & (whole > 0)
    for shares, part, there in ((False, work / top, hit), (True, work / np.maximum(whole, 1), due)):
        drawn = picture(frame, view, shares=shares).astype(int)
        entry = np.clip(part[there] * 256.0 - 0.5, 0.0, 255.0).round().astype(int)
        assert np.abs(drawn[there] - MAP[entry]).max() <= 2
    assert (picture(frame, view, shares=True)[hit & (whole == 0)] == in_bytes(GREY)).all()


@pytest.mark.parametrize(("view", "layer"), [(View.CELL_LIGHTS, "cell lights"), (View.CUTS, "cut nodes")])
def test_counts_are_mapped_from_0_to_the_most_and_grey_where_not_known(frame: Frame, view: View, layer: str) -> None:
    counts, drawn = frame.layers[layer], picture(frame, view).astype(int)
    lines = on_lines(frame.cell) if view is View.CELL_LIGHTS else np.zeros(counts.shape, np.bool_)
    for number, color in ((-1, in_bytes(GREY)), (0, MAP[0]), (counts.max(), MAP[-1])):
        there = (frame.primitive >= 0) & (counts == number)
        assert np.abs(drawn[there & ~lines] - color).max(initial=0) <= 1
        assert np.abs(drawn[there & lines] - FAINT_LINE * color).max(initial=0) <= 2
    part, hit = in_part(frame), frame.primitive >= 0
    assert (picture(part, View.LIGHTS)[hit & ~part.shaded] == in_bytes(GREY)).all()


@pytest.mark.parametrize("cut", [Slice(0, 0.6), Slice(1, 0.5), Slice(2, 0.7)])
@pytest.mark.parametrize("light", [0, 1])
def test_a_slice_has_the_colours_of_its_voxels_over_the_dimmed_picture(frame: Frame, cut: Slice, light: int) -> None:
    drawn, (numbers, lines) = picture(frame, View.VOXELS, light, slice=cut), voxels_seen(frame, cut)
    there = numbers >= 0
    states = (voxels_of(frame).words[numbers[there]] >> np.uint32(2 + 2 * light)) & 3
    assert set(states.tolist()) == {0, 1, 2}
    color = np.asarray([STATES[state][0] for state in range(3)], np.float32)[states]
    color[lines[there]] *= np.float32(CELL_LINE)
    assert (drawn[there] == in_bytes(color)).all()
    behind = ~there & (frame.primitive >= 0)
    assert np.abs(drawn[behind] - BENEATH * picture(frame)[behind].astype(float)).max() <= 1


def test_what_a_frame_has_not_is_not_drawn(plain: Frame) -> None:
    for view in View:
        if view.records or view in (View.CERTIFICATE, View.CUTS, View.VOXELS, View.CELL_LIGHTS):
            with pytest.raises(ValueError, match=f"nothing for the view {view.label}"):
                picture(plain, view)
            assert legend_in(plain, view) is None and words_in(plain, view, 0, 0, 0) == ()
    for view in (View.SHADOW, View.CERTIFICATE, View.PENUMBRA):
        with pytest.raises(ValueError, match="no light 2: the scene's lights are 0 to 1"):
            picture(plain, view, 2)


@pytest.mark.gui
@pytest.mark.parametrize("view", list(View))
def test_the_window_shows_the_same_and_what_is_selected(frame: Frame, view: View) -> None:
    """Bit for bit, but for a bright border on both sides of the edge of what is selected."""
    moderngl = pytest.importorskip("moderngl")
    from viewer.window.display import Display, InWindow

    how = options(view, 1, mark_wrong=False, wipe=0.4, outlines=True, magnified=2)
    context = moderngl.create_context(standalone=True, require=330)
    with context:
        display = Display(context)
        display.draw(frame, how)
        here, version = colorize(frame, how), display.version
        assert np.array_equal(display.read(), here)
        display.draw(frame, replace(how, legend=True))
        assert display.draw(frame, how) and display.version == version, "nothing of the pixels has changed"
        chosen = int(frame.primitive[40, 50])
        display.draw(frame, how, InWindow(selected=chosen))
        inside = np.pad(frame.primitive == chosen, 1, mode="edge")
        around = [inside[y : y + here.shape[0], x : x + here.shape[1]] for y in range(3) for x in range(3)]
        border = np.any(around, axis=0) & ~np.all(around, axis=0)
        assert border.any() and (display.read()[border] == 255).all()
        assert np.array_equal(display.read()[~border], here[~border])
        display.part_of = np.zeros(frame.primitive.max() + 1, np.int32)
        display.draw(frame, how, InWindow(selected=chosen, selected_part=0))
        assert (display.read()[border] == 255).mean() < 1.0, "it is the part that has the border"
    context.release()


def test_each_view_declares_what_a_person_needs_to_find_it() -> None:
    assert len({view.key for view in View}) == len({view.label for view in View}) == len(View)
    for view in View:
        assert view.help.endswith(".") and view.label[0].isupper(), view
    files = {path.stem for path in Path(views.__file__).parent.glob("*.py")}
    assert {view.value.replace("-", "_") for view in View} <= files
