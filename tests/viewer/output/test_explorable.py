"""The page that can be explored, in a real browser: what it tells of a pixel is what the frame has."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import viewer
from tests.viewer.browser import CHROMIUM, Page, browser
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.inspect.why_in_words import primitive_in_words
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from tracer.scene.model import Scene
from viewer.__main__ import main
from viewer.output import explorable
from viewer.output.comparison import Comparison, Shown
from viewer.services import stills
from viewer.state.palette import FATES, OCCLUSION, SHADOW
from viewer.state.view_state import ViewState
from viewer.util.resources import scene_path

pytestmark = pytest.mark.skipif(not CHROMIUM, reason="no Chromium is installed")
TOLD = "document.getElementById('pixel').innerText"


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene(scene_path("figure3"))


@pytest.fixture(scope="module")
def shown(scene: Scene) -> Shown:
    settings = Settings(width=48, height=36, modes=True, threads=1)
    state = ViewState(str(scene.path), settings=settings, time=scene.frame_time(0))
    world = World(scene, state.time, settings.accelerator)
    return stills.trace_methods(scene, state, Comparison(("paper",)), world, records=explorable.RECORDS)


@pytest.fixture(scope="module")
def page(shown: Shown, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Page, Path]]:
    folder = tmp_path_factory.mktemp("explorable")
    explorable.save(shown, World(shown.scene, shown.state.time, "kdtree"), folder / "page.html")
    with browser(folder / "browser") as opened:
        yield opened, folder / "page.html"


def told_of(frame: Frame, scene: Scene, x: int, y: int, light: int) -> set[str]:
    """What must be said of a pixel."""
    return {
        primitive_in_words(scene, int(frame.primitive[y, x])),
        OCCLUSION[frame.occlusion_mode[y, x]].name,
        SHADOW[frame.shadow_mode[y, x, light]].name,
        FATES[frame.fate(light)[y, x]].name,
        f"{frame.due_rays[y, x]}",
    }


def test_what_is_said_of_pixels_is_what_the_frame_has(page: tuple[Page, Path], shown: Shown, scene: Scene) -> None:
    opened, path = page
    frame, rng = shown.frames["paper"], np.random.default_rng(4)
    hit = np.argwhere(frame.primitive >= 0)
    for y, x in hit[rng.choice(len(hit), 12, replace=False)]:
        opened.open(path, f"pixel={x},{y}")
        said = opened.ask(TOLD)
        missing = {words for words in told_of(frame, scene, x, y, 0) if words not in said}
        assert not missing, (x, y, missing, said)


def test_a_click_and_an_arrow_key_choose_the_pixel(page: tuple[Page, Path]) -> None:
    opened, path = page
    opened.open(path)
    assert opened.ask(TOLD) == "Click a pixel."
    left, top, width, height = opened.ask(
        "(() => { const b = document.getElementById('picture').getBoundingClientRect();"
        " return [b.left, b.top, b.width, b.height]; })()"
    )
    opened.click(left + width * 20.5 / 48, top + height * 10.5 / 36)
    assert opened.ask(TOLD).startswith("Pixel 20, 10")
    opened.ask("document.getElementById('picture').focus()")
    opened.press("ArrowRight")
    assert opened.ask(TOLD).startswith("Pixel 21, 10")
    assert "pixel=21%2C10" in opened.ask("location.hash")


def test_views_have_the_colours_of_the_palette_and_a_wipe_two_methods(page: tuple[Page, Path], shown: Shown) -> None:
    opened, path = page
    read = "Array.from(document.getElementById('picture').getContext('2d').getImageData(0, 0, 48, 36).data)"
    frames = shown.reference, shown.frames["paper"]
    for kind, classes in (("occlusion", OCCLUSION), ("fate", FATES)):
        opened.open(path, f"method=none&other=paper&wipe=0.5&view={kind}&light=0")
        drawn = np.array(opened.ask(read)).reshape(36, 48, 4)[..., :3]
        for frame, columns in zip(frames, (slice(0, 24), slice(25, 48)), strict=True):
            of = frame.occlusion_mode if kind == "occlusion" else frame.fate(0)
            hit = (frame.primitive >= 0)[:, columns]
            right = np.array([np.round(255 * np.array(one.color)) for one in classes.values()])
            assert (drawn[:, columns][hit] == right[of[:, columns][hit]]).all(), kind


def test_what_blocks_a_light_is_between(shown: Shown, scene: Scene) -> None:
    world, frame = World(scene, shown.state.time, "bvh8"), shown.reference
    found = explorable.blockers(frame, world, scene.light_positions(frame.time), 0)
    dark = (frame.asked[..., 0] > 0) & (frame.reached[..., 0] == 0)  # type: ignore[index]
    assert (found[dark] >= 0).mean() > 0.95 and dark.any() and (found[~dark] == -1).all()


def test_the_example_of_the_documentation_runs_fetches_nothing_and_can_be_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    page = (Path(__file__).parents[3] / "docs" / "explore.md").read_text()
    command = page.split("```sh\n")[1].split("\n```")[0]
    assert main(shlex.split(command)[1:]) == 0
    text = (tmp_path / "room.html").read_text()
    assert "http:" not in text and "https:" not in text and len(text) < 1_000_000
    with browser(tmp_path / "browser") as opened:
        opened.open(tmp_path / "room.html", "method=paper&view=difference&pixel=64,64")
        assert "Paper" in opened.ask(TOLD)
        again = opened.ask("document.getElementById('command').innerText")
    assert main(shlex.split(again)[1:]) == 0
    assert (tmp_path / "figure.html").read_text() == text


def test_a_notebook_shows_a_frame_by_a_page(
    page: tuple[Page, Path], shown: Shown, scene: Scene, tmp_path: Path
) -> None:
    opened, _ = page
    frame = shown.frames["paper"]
    inside = "document.querySelector('iframe').contentDocument"
    for given, named in ((scene, primitive_in_words(scene, int(frame.primitive[10, 20]))), (None, "primitive")):
        html = viewer.explore(frame, given)._repr_html_()
        (tmp_path / "notebook.html").write_text(f"<body data-ready='yes' style='width:1200px'>{html}</body>")
        opened.open(tmp_path / "notebook.html")
        wait = f"new Promise((done) => {{ const look = () => {inside}?.body?.dataset.ready ? done(true) : "
        assert opened.ask(wait + "setTimeout(look, 20); look(); })")
        left, top, width, height = opened.ask(
            f"(() => {{ const b = {inside}.getElementById('picture').getBoundingClientRect(),"
            " f = document.querySelector('iframe').getBoundingClientRect();"
            " return [b.left + f.left, b.top + f.top, b.width, b.height]; })()"
        )
        opened.click(left + width * 20.5 / 48, top + height * 10.5 / 36)
        said = opened.ask(f"{inside}.getElementById('pixel').innerText")
        assert said.startswith("Pixel 20, 10") and named in said, said
        assert OCCLUSION[frame.occlusion_mode[10, 20]].name in said and f"{frame.due_rays[10, 20]}" in said  # type: ignore[index]


def test_a_frame_that_recorded_nothing_has_a_page_of_what_it_has(scene: Scene, tmp_path: Path) -> None:
    frame = Renderer(scene, Settings(width=48, height=36, method="none", threads=1)).render(scene.frame_time(0))
    (tmp_path / "page.html").write_text(viewer.explore(frame).html)
    with browser(tmp_path / "browser") as opened:
        opened.open(tmp_path / "page.html", "pixel=20,10")
        assert opened.ask(TOLD).startswith("Pixel 20, 10")
        views = opened.ask("Array.from(document.getElementById('view').options).map((o) => o.value)")
    assert "primitive" in views and not {"fate", "traced", "difference"} & set(views)


def test_the_extension_of_notebooks_makes_frames_show_pages(shown: Shown) -> None:
    known: dict[type, Callable[[Frame], str]] = {}
    formatter = SimpleNamespace(for_type=known.__setitem__)
    ipython = SimpleNamespace(display_formatter=SimpleNamespace(formatters={"text/html": formatter}))
    viewer.load_ipython_extension(ipython)
    frame = shown.frames["paper"]
    assert known[Frame](frame) == viewer.explore(frame)._repr_html_()
    large = replace(frame, primitive=np.zeros((700, 700), np.int32))
    assert known[Frame](large) == large._repr_html_()


def test_pages_that_would_be_too_large_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["figure", "figure4", "-o", "no.html", "--size", "2000x2000"]) == 1
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "307,200" in line
