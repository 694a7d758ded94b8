"""The colours of views mean what their legends say, and the window shows the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.viewer.drawn import options, picture, values_in
from tests.viewer.fakes import (
    FLYER_SCENE,
    in_cells,
    in_part,
    with_cell_lights,
    with_certificates,
    with_cuts,
    with_lamps,
    with_tree,
    with_voxels,
)
from tracer.culling.fate import MOVING_SHADOW, TRACED, Fate
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.frame import Frame, Settings
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from viewer import views
from viewer.state.draw_options import SHADING, Slice
from viewer.state.palette import (
    BACKGROUND,
    BENEATH,
    CERTIFICATE_COLORS,
    FATE_COLORS,
    GREY,
    OCCLUSION_COLORS,
    SHADOW_COLORS,
    WIPE_LINE,
    WRONG,
    Certificate,
    color_map,
)
from viewer.state.views import View
from viewer.views import colorize
from viewer.views.moving_shadow import MOVING_SHADOWS, MovingShadow
from viewer.views.paint import CELL_LINE, FAINT_LINE
from viewer.views.penumbra import ARRIVALS, Arrival
from viewer.views.slices import slice_seen, tree_seen
from viewer.views.tree import tree_of
from viewer.views.voxels import STATES, voxels_of


@pytest.fixture(scope="module")
def frame(tmp_path_factory: pytest.TempPathFactory) -> Frame:
    """The third frame of a small scene, with a sphere that hides a part of the floor and a triangle that moves."""
    path = tmp_path_factory.mktemp("pictures") / "scene.aff"
    path.write_text(FLYER_SCENE)
    renderer = Renderer(load_scene(path), Settings(width=96, height=64, threads=1))
    return [renderer.render(time) for time in (1.0, 2.0, 3.0)][-1]


def recorded(frame: Frame) -> Frame:
    """The frame with what became of each shadow ray: those of what moves, and of what it hides light from, by hand."""
    asks, shape = np.full((*frame.primitive.shape, frame.lights), TRACED, np.uint8), frame.primitive.shape
    asks[:, : shape[1] // 2] |= MOVING_SHADOW
    return replace(frame, fates=asks)


@pytest.fixture(scope="module")
def wrong_frame(frame: Frame) -> Frame:
    """The same with wrong answers put into it: a pixel alone, two in corners, and a block; their colours differ."""
    wrong = np.zeros((frame.height, frame.width), np.int32)
    wrong[20, 30] = 1
    wrong[0, 0] = wrong[-1, -1] = 2
    wrong[40:46, 60:75] = 3
    reference = frame.color.copy()
    reference[wrong > 0] = 1.0 - reference[wrong > 0]
    return replace(frame, settings=replace(frame.settings, verify=True), wrong=wrong, reference=reference)


@pytest.fixture(scope="module")
def certified_frame(wrong_frame: Frame) -> Frame:
    """The same with cells and their certificates, the work at each pixel, and lamps that reach it in part."""
    return with_tree(with_cell_lights(with_voxels(with_cuts(with_lamps(with_certificates(wrong_frame))))))


def to_bytes(color: tuple[float, ...]) -> np.ndarray:
    return np.round(np.asarray(color) * 255.0).astype(np.uint8)


def test_colours_are_clamped_and_otherwise_untouched(frame: Frame) -> None:
    expected = np.round(np.clip(frame.color, 0, 1) * 255).astype(np.uint8)
    np.testing.assert_array_equal(picture(frame), expected)


@pytest.mark.parametrize("view", [v for v in View if v is not View.COLOR and not v.needs_verify])
def test_what_is_missed_has_the_background(certified_frame: Frame, view: View) -> None:
    missed = certified_frame.primitive < 0
    if view.has_slice:  # it is seen before the background, too
        missed &= ~values_in(certified_frame, view).known
    assert missed.any()
    assert (picture(certified_frame, view)[missed] == to_bytes(BACKGROUND)).all()


def test_occlusion_modes_have_their_colours(frame: Frame) -> None:
    drawn = picture(frame, View.OCCLUSION, shading=0.0)
    seen = set()
    for mode in OcclusionMode:
        there = frame.occlusion_mode == mode
        assert (drawn[there] == to_bytes(OCCLUSION_COLORS[mode])).all()
        seen |= {mode} if there.any() else set()
    assert {OcclusionMode.PARTIALLY_OCCLUDED, OcclusionMode.FULLY_RENDERED, OcclusionMode.DYNAMIC} <= seen


@pytest.mark.parametrize("light", [0, 1])
def test_shadow_modes_have_their_colours(frame: Frame, light: int) -> None:
    word = frame.modes.dtype.type
    rest = np.where(frame.modes & word(3) == word(OcclusionMode.DYNAMIC), word(3), word(OcclusionMode.INIT))
    for shown, untrusted in ((frame, False), (replace(frame, modes=frame.modes & ~word(3) | rest), True)):
        assert_shadow_modes_drawn(shown, light, untrusted)


def assert_shadow_modes_drawn(frame: Frame, light: int, untrusted: bool) -> None:
    drawn = picture(frame, View.SHADOW, light, shading=0.0)
    moving = frame.occlusion_mode == OcclusionMode.DYNAMIC
    assert (drawn[moving] == to_bytes(OCCLUSION_COLORS[OcclusionMode.DYNAMIC])).all()
    culls, doubted = (ShadowMode.FULL_SHADOW, ShadowMode.NON_SHADOW), 0
    y, x = np.indices(moving.shape)
    for mode in ShadowMode:
        there = (frame.shadow_mode[..., light] == mode) & ~moving
        striped = there & (frame.occlusion_mode != OcclusionMode.FULLY_RENDERED) & (mode in culls)
        doubted += striped.sum()
        striped &= (x + y) // 3 % 2 == 1
        assert (drawn[there & ~striped] == to_bytes(SHADOW_COLORS[mode])).all()
        assert (drawn[striped] == to_bytes(SHADOW_COLORS[ShadowMode.INIT])).all(), "not trusted"
    assert (doubted > 50) == untrusted


def test_modes_of_cells_are_those_that_are_drawn(frame: Frame) -> None:
    cells = in_cells(frame)
    drawn = picture(cells, View.SHADOW, 0, shading=0.0)
    still = (cells.primitive >= 0) & (frame.occlusion_mode == OcclusionMode.FULLY_RENDERED)
    mode = (cells.modes[cells.cells] >> 2) & 3
    for one in ShadowMode:
        assert (drawn[still & (mode == one)] == to_bytes(SHADOW_COLORS[one])).all()
    assert (drawn[:, ::2] != picture(frame, View.SHADOW, 0, shading=0.0)[:, 1::2]).any()


def test_every_primitive_has_a_colour_of_its_own(frame: Frame) -> None:
    drawn = picture(frame, View.PRIMITIVE, shading=0.0)
    hit = frame.primitive >= 0
    colors = {tuple(c) for c in drawn[hit]}
    assert len(colors) == len(np.unique(frame.primitive[hit]))


def test_a_light_past_the_culled_ones_is_drawn_as_unknown(frame: Frame) -> None:
    many = replace(frame, lights=40)
    drawn = picture(many, View.SHADOW, 35, shading=0.0)
    still = (frame.primitive >= 0) & (frame.occlusion_mode != OcclusionMode.DYNAMIC)
    assert (drawn[still] == to_bytes(GREY)).all()


@pytest.mark.parametrize("light", [0, 1])
def test_certificates_have_their_colours_and_cells_their_lines(certified_frame: Frame, light: int) -> None:
    f = certified_frame
    drawn = picture(f, View.CERTIFICATE, light, shading=0.0)
    moving = f.occlusion_mode == OcclusionMode.DYNAMIC
    line = np.zeros_like(moving)
    for y, x in np.argwhere(f.primitive >= 0):
        right, below = f.cells[y, min(x + 1, f.width - 1)], f.cells[min(y + 1, f.height - 1), x]
        line[y, x] = right != f.cells[y, x] or below != f.cells[y, x]
    assert 0.1 < line[f.cells >= 0].mean() < 0.6
    for certificate in Certificate:
        there = (f.primitive >= 0) & ~moving & ((f.certificates >> (2 + 2 * light)) & 3 == certificate)
        color = np.asarray(CERTIFICATE_COLORS[certificate])
        assert there.any() and (drawn[there & ~line] == to_bytes(color)).all()
        assert (drawn[there & line] == to_bytes(np.float32(CELL_LINE) * color.astype(np.float32))).all()
    assert (drawn[moving & ~line] == to_bytes(OCCLUSION_COLORS[OcclusionMode.DYNAMIC])).all()


@pytest.mark.parametrize("view", [View.SAVED, View.COST])
def test_work_is_mapped_up_to_nearly_the_most(certified_frame: Frame, view: View) -> None:
    work = certified_frame.saved if view is View.SAVED else certified_frame.cost
    drawn, top = picture(certified_frame, view), view.declared.span(certified_frame)[1]
    hit = certified_frame.primitive >= 0
    assert np.mean(work[hit] > top) <= 0.01 and (work[hit] >= 0.9 * top).any()
    colors = np.round(color_map() * 255).astype(int)
    assert np.abs(drawn[hit & (work >= top)].astype(int) - colors[-1]).max() <= 1
    for rays in np.unique(work[hit]):
        shown = drawn[hit & (work == rays)].astype(int)
        entry = min(max(rays / top * 256.0 - 0.5, 0.0), 255.0)
        assert (shown == shown[0]).all() and np.abs(shown[0] - colors[round(entry)]).max() <= 2


@pytest.mark.parametrize("view", [View.SAVED, View.COST])
def test_shares_of_work_are_mapped_from_none_to_all(certified_frame: Frame, view: View) -> None:
    f = certified_frame
    work, whole = (f.saved, f.due_rays) if view is View.SAVED else (f.cost, f.saved + f.cost)
    drawn, hit = picture(f, view, shares=True), f.primitive >= 0
    none, all_of_it = hit & (whole == 0), hit & (whole > 0) & (work == whole)
    colors = np.round(color_map() * 255).astype(int)
    assert (drawn[none] == to_bytes(GREY)).all() and all_of_it.any() and none.any() == (view is View.SAVED)
    assert np.abs(drawn[all_of_it].astype(int) - colors[-1]).max() <= 1
    part = hit & (whole > 0)
    entry = np.clip(work[part] / whole[part] * 256.0 - 0.5, 0.0, 255.0).round().astype(int)
    assert np.abs(drawn[part].astype(int) - colors[entry]).max() <= 2


@pytest.mark.parametrize("light", [0, 1])
def test_penumbrae_are_a_ramp_between_dark_and_lit(certified_frame: Frame, light: int) -> None:
    f = certified_frame
    drawn, hit = picture(f, View.PENUMBRA, light, shading=0.0), f.primitive >= 0
    asked, reached = f.asked[..., light].astype(int), f.reached[..., light].astype(int)
    for one, there in (
        (Arrival.AWAY, asked == 0),
        (Arrival.DARK, (asked > 0) & (reached == 0)),
        (Arrival.LIT, (asked > 0) & (reached == asked)),
    ):
        assert there.any() and (drawn[hit & there] == to_bytes(ARRIVALS[one][1])).all()
    between = hit & (reached > 0) & (reached < asked)
    assert between.any() == (light == 0), "a point has no penumbra"
    few, most = (np.asarray(ARRIVALS[one][1]) for one in (Arrival.FEW, Arrival.MOST))
    share = (reached[between] / asked[between])[:, None]
    assert np.abs(drawn[between] - 255.0 * (few + share * (most - few))).max(initial=0) <= 1


def test_fates_have_their_colours(frame: Frame) -> None:
    told, light = recorded(frame), 0
    drawn, fates = picture(told, View.FATE, light, shading=0.0), told.fate(light)
    seen = set()
    for fate in Fate:
        there = (fates == fate) & (told.primitive >= 0)
        assert (drawn[there] == to_bytes(FATE_COLORS[fate])).all()
        seen |= {fate} if there.any() else set()
    assert seen >= {Fate.DYNAMIC_ONLY, Fate.PARTLY_OCCLUDED, Fate.DYNAMIC}


def test_shadows_of_moving_objects_stand_out_of_the_paled_picture(frame: Frame) -> None:
    told, light = recorded(frame), 0
    drawn = picture(told, View.MOVING_SHADOW, light, shading=0.0).astype(int)
    dark, asked = told.moving_shadow(light), told.fate(light) == Fate.DYNAMIC_ONLY
    assert (dark & asked).any()
    for there, code in ((dark & asked, MovingShadow.DARK), (dark & ~asked, MovingShadow.TRACED)):
        assert (drawn[there] == to_bytes(MOVING_SHADOWS[code][1])).all()
    rest = (told.primitive >= 0) & ~dark & ~asked & (told.occlusion_mode != OcclusionMode.DYNAMIC)
    assert rest.any()
    grey = picture(told)[rest] @ np.array([0.2126, 0.7152, 0.0722])
    assert np.abs(drawn[rest] - (127.5 + grey / 2.0)[:, None]).max() <= 1.5


def test_what_is_not_known_yet_looks_like_nothing_that_is(certified_frame: Frame) -> None:
    f = certified_frame
    part, hit = in_part(f), f.primitive >= 0
    for view, unknown in ((View.PENUMBRA, ARRIVALS[Arrival.UNKNOWN][1]), (View.LIGHTS, GREY)):
        drawn, whole = (picture(one, view, 0, shading=0.0) for one in (part, f))
        assert (drawn[hit & ~part.shaded] == to_bytes(unknown)).all()
        assert not (whole[hit] == to_bytes(unknown)).all(axis=-1).any()
        assert np.array_equal(drawn[part.shaded], whole[part.shaded])


@pytest.mark.parametrize("cut", [Slice(0, 0.6), Slice(1, 0.5), Slice(2, 0.7)])
@pytest.mark.parametrize("light", [0, 1])
def test_a_slice_has_the_colours_of_its_voxels_over_the_dimmed_picture(
    certified_frame: Frame, cut: Slice, light: int
) -> None:
    f, states = certified_frame, voxels_of(certified_frame)
    drawn, numbers = picture(f, View.VOXELS, light, slice=cut), slice_seen(f, states.grid, cut).numbers
    assert 0.005 < (numbers >= 0).mean() < 0.98
    seen = set()
    for y, x in np.argwhere(numbers >= 0):
        state = int(states.words[numbers[y, x]] >> np.uint32(2 + 2 * light)) & 3
        color = np.asarray(STATES[state][0], np.float32)
        assert (drawn[y, x] == to_bytes(color)).all() or (drawn[y, x] == to_bytes(np.float32(CELL_LINE) * color)).all()
        seen.add(state)
    assert seen == {0, 1, 2}
    behind = (numbers < 0) & (f.primitive >= 0)
    assert np.abs(drawn[behind] - BENEATH * picture(f)[behind].astype(float)).max() <= 1


@pytest.mark.parametrize("cut", [Slice(0, 0.45), Slice(1, 0.5), Slice(2, 0.7)])
def test_parts_of_a_tree_have_the_colours_of_their_levels_and_what_waits_has_stripes(
    certified_frame: Frame, cut: Slice
) -> None:
    f, tree = certified_frame, tree_of(certified_frame)
    drawn, seen = picture(f, View.TREE, slice=cut), tree_seen(f, tree, cut)
    there, colors = seen.parts.numbers >= 0, color_map()
    assert 0.005 < there.mean() < 0.98
    for y, x in np.argwhere(there):
        level, waits = int(seen.parts.levels[y, x]), not seen.parts.built[y, x]
        stripe = (0.29, 0.306, 0.341) if (x + y) // 4 % 2 == 0 else (0.42, 0.439, 0.482)
        color = np.asarray(stripe if waits else colors[round(level / 8 * (len(colors) - 1))], np.float32)
        light = 0.25 + 0.95 * np.sqrt(np.clip(f.color[y, x], 0.0, 1.0) @ (0.2126, 0.7152, 0.0722))
        shade = 1.0 + SHADING * (light - 1.0) if seen.hidden[y, x] else 1.0
        expected = [255.0 * np.clip(shade * line * color, 0.0, 1.0) for line in (1.0, FAINT_LINE)] + [np.full(3, 255.0)]
        assert min(np.abs(drawn[y, x] - one).max() for one in expected) <= 3.0, (x, y)
    behind = ~there & (f.primitive >= 0)
    assert np.abs(drawn[behind] - BENEATH * picture(f)[behind].astype(float)).max() <= 1


def test_cells_have_the_colour_of_how_many_lights_they_ask(certified_frame: Frame) -> None:
    f = certified_frame
    asked, drawn = f.layers["cell lights"], picture(f, View.CELL_LIGHTS)
    line = np.zeros(asked.shape, np.bool_)
    line[:, :-1] |= f.cells[:, 1:] != f.cells[:, :-1]
    line[:-1] |= f.cells[1:] != f.cells[:-1]
    colors = np.round(color_map() * 255).astype(int)
    for number, color in ((-1, to_bytes(GREY)), (0, colors[0]), (2, colors[-1])):
        there = (f.primitive >= 0) & (asked == number)
        assert (there & ~line).any() and np.abs(drawn[there & ~line].astype(int) - color).max() <= 1
        assert (there & line).any() and np.abs(drawn[there & line] - FAINT_LINE * color).max() <= 2


@pytest.mark.parametrize(
    ("views", "said"),
    [
        ((View.SAVED, View.COST), "did not record the work"),
        ((View.FATE, View.MOVING_SHADOW), "did not record what became of"),
        ((View.PENUMBRA,), "did not record which samples"),
        ((View.DIFFERENCE, View.WIPE), "not verified"),
    ],
)
def test_what_a_frame_did_not_record_cannot_be_drawn(frame: Frame, views: tuple[View, ...], said: str) -> None:
    for view in views:
        with pytest.raises(ValueError, match=said):
            picture(replace(frame, asked=None), view)


def test_a_light_that_is_not_there(frame: Frame) -> None:
    for view in (View.SHADOW, View.CERTIFICATE, View.PENUMBRA):
        with pytest.raises(ValueError, match="no light 2: the scene's lights are 0 to 1"):
            picture(frame, view, 2)


@pytest.mark.parametrize("beneath", [0.0, BENEATH, 0.6])
def test_what_is_wrong_has_the_one_colour_over_the_dimmed_picture(wrong_frame: Frame, beneath: float) -> None:
    drawn = picture(wrong_frame, View.DIFFERENCE, mark_wrong=False, beneath=beneath)
    wrong = wrong_frame.wrong > 0
    assert (drawn[wrong] == to_bytes(WRONG)).all()
    expected = beneath * picture(wrong_frame)[~wrong].astype(float)
    assert np.abs(drawn[~wrong] - expected).max() <= 1 and drawn[~wrong].any() == (beneath > 0.0)


def test_where_all_is_right_nothing_is_marked(frame: Frame) -> None:
    right = replace(frame, wrong=np.zeros_like(frame.primitive), reference=frame.color)
    assert np.abs(picture(right, View.DIFFERENCE) - BENEATH * picture(frame)).max() <= 1
    pixels = picture(right, View.WIPE)
    column = frame.width // 2
    assert (pixels[:, column] == to_bytes(WIPE_LINE)).all()
    np.testing.assert_array_equal(np.delete(pixels, column, 1), np.delete(picture(frame), column, 1))


@pytest.mark.parametrize(("wipe", "column"), [(0.0, 0), (0.3, 28), (1.0, 96)])
def test_a_wipe_shows_both_pictures(wrong_frame: Frame, wipe: float, column: int) -> None:
    pixels = picture(wrong_frame, View.WIPE, mark_wrong=False, wipe=wipe)
    right = picture(replace(wrong_frame, color=wrong_frame.reference))
    np.testing.assert_array_equal(pixels[:, :column], picture(wrong_frame)[:, :column])
    np.testing.assert_array_equal(pixels[:, column + 1 :], right[:, column + 1 :])
    marked = picture(wrong_frame, View.WIPE, wipe=wipe)
    ring = (marked == to_bytes(WRONG)).all(axis=-1)
    assert ring.any() and not (ring & (wrong_frame.wrong > 0)).any()
    np.testing.assert_array_equal(marked[~ring], pixels[~ring])


@pytest.mark.gui
@pytest.mark.parametrize("view", list(View))
def test_the_window_shows_the_same_and_what_is_selected(certified_frame: Frame, view: View) -> None:
    """Bit for bit, but for a bright border on both sides of the edge of what is selected."""
    moderngl = pytest.importorskip("moderngl")
    from viewer.window.display import Display, InWindow

    how = options(view, 1, mark_wrong=False, wipe=0.4, outlines=True, magnified=2)
    context = moderngl.create_context(standalone=True, require=330)
    with context:
        display = Display(context)
        display.draw(certified_frame, how)
        here, version = colorize(certified_frame, how), display.version
        read = np.frombuffer(display.picture.read(alignment=1), np.uint8).reshape(here.shape)
        assert np.array_equal(read, here) and np.array_equal(display.read(), here)
        display.draw(certified_frame, replace(how, legend=True))
        assert display.version == version and display.shows(how), "nothing of the pixels has changed"
        chosen = int(certified_frame.primitive[40, 50])
        display.draw(certified_frame, how, InWindow(selected=chosen))
        inside = np.pad(certified_frame.primitive == chosen, 1, mode="edge")
        around = [inside[y : y + here.shape[0], x : x + here.shape[1]] for y in range(3) for x in range(3)]
        border = np.any(around, axis=0) & ~np.all(around, axis=0)
        assert border.any() and (display.read()[border] == 255).all()
        assert np.array_equal(display.read()[~border], here[~border])
        display.part_of = np.zeros(certified_frame.primitive.max() + 1, np.int32)
        display.draw(certified_frame, how, InWindow(selected=chosen, selected_part=0))
        assert (display.read()[border] == 255).mean() < 1.0, "it is the part that has the border"
        display.release()
    context.release()


def test_each_view_declares_what_a_person_needs_to_find_it() -> None:
    assert len({view.key for view in View}) == len({view.label for view in View}) == len(View)
    for view in View:
        assert view.help.endswith(".") and view.label[0].isupper(), view
    files = {path.stem for path in Path(views.__file__).parent.glob("*.py")}
    assert {view.value.replace("-", "_") for view in View} <= files
