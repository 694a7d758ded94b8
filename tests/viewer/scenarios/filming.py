"""Films: planned in their panel, traced while one watches, stopped, and written."""

from __future__ import annotations

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tests.viewer.driver import Driver
from viewer.state.views import View

KEY = imgui.Key


def filming(d: Driver) -> None:
    """A path, with its modes; a flight through bookmarks; and one that is stopped."""
    pictures, films, runs = d.folder / "pictures", d.c.films, d.c.runs
    d.settle()
    d.see(View.OCCLUSION)
    next(c for c in d.ui.commands if c.name == "Film").run()
    d.frames(3)
    start = f"//Film/**/{icons.ICON_FA_PLAY}  Start"
    films.plan.last, films.plan.size, films.plan.legend = 4, (160, 120), True
    assert films.count == 5
    d.click(start)
    d.wait(lambda: runs.current is not None, "the film to begin")
    d.c.questions.before_opening("another scene", lambda: None)
    d.wait(lambda: films.film is not None and runs.current is None, "the film")
    d.settle()
    assert d.c.questions.question is None, "whether to stop it is asked although it is done"
    assert films.film.whole and "film done: 5 frames" in d.said
    folder = films.film.folder
    assert folder.parent == pictures and len(list(folder.iterdir())) == 5

    d.click("//Film/**/###bookmarks")
    assert films.plan.through_bookmarks and films.count == 0
    d.click(start)
    assert d.c.notices.message.error and "two bookmarks" in d.said
    d.c.bookmarks.add()
    d.hold(KEY.d, 0.2)
    d.settle()
    d.c.bookmarks.add()
    films.plan.fps, films.plan.seconds = 50.0, 60.0
    assert films.count == 3000
    d.click(start)
    d.wait(lambda: films.film.traced > 3, "frames of the flight")
    assert d.c.scheduler.drawn_view is View.OCCLUSION
    d.press(KEY.escape)
    d.wait(lambda: runs.current is None, "the film to stop", 20.0)
    d.settle()
    assert 3 < len(list(films.film.folder.iterdir())) < 3000
    assert "is kept" in d.said and str(films.film.folder) in d.said
