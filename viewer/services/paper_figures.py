"""The paper's Table 1, Figure 3 and Figure 4 by one command each, in the scenes and sizes that show something.

Part by part, in later frames of the window: a scene is opened, something in it is selected, a run is started."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from viewer.services.controller import Controller
from viewer.services.frame_scheduler import Activity
from viewer.state.methods import BY_MODES
from viewer.state.plans import ExperimentPlan, ZoomPlan
from viewer.state.views import View
from viewer.util.resources import default_scene, embedded_scenes

FIGURE_3, FIGURE_4 = (embedded_scenes()[name] for name in ("figure3", "figure4"))
_CARDS = 9  # pixels of figure3: in finer pictures other rays find what the test misses
SIDE = 128
"""Pixels of pictures of figure4, for which the scene is made: in larger ones a ray meets the small shadow from afar."""

Condition = Callable[[Controller], bool]
Act = Callable[[Controller], object]
"""Brings a condition about; called in each frame of the window until that holds."""


class Part(NamedTuple):
    """A condition that must hold once, and what brings it about; the tour does by itself what only `sets_stage`."""

    holds: Condition
    act: Act
    sets_stage: bool = False


def is_open(c: Controller, path: Path) -> bool:
    """Return whether a scene is the one that is open."""
    return c.session.scene is not None and c.session.scene.path == path


def open_scene(path: Path) -> Act:
    """Open a scene, unless it is open or on its way."""

    def act(c: Controller) -> None:
        if not is_open(c, path) and c.loader.load_job is None:
            c.loader.open(path)

    return act


def opened(path: Path) -> Part:
    """Return the part that opens a scene, and waits until its picture rests."""

    def holds(c: Controller) -> bool:
        rests = c.scheduler.activity in (Activity.RESTING, Activity.ADDING_SAMPLES)
        return is_open(c, path) and c.frame is not None and rests and not c.loader.busy

    return Part(holds, open_scene(path), True)


class PaperFigures:
    """Brings the parts of one figure about, in one scene."""

    def __init__(self, controller: Controller) -> None:
        self._c, self._path = controller, FIGURE_4
        self._waiting: list[Part] = []
        self._way_back = ""  # in words, to the scene that was open before

    def update(self) -> None:
        """Bring the next part about, once in each frame of the window, unless another scene was opened meanwhile."""
        if not self._c.loader.busy and not is_open(self._c, self._path):
            self._waiting = []
        for part in self._waiting[:1]:
            part.act(self._c)
            if part.holds(self._c):
                self._waiting.remove(part)

    def _begin(self, path: Path, *parts: Part) -> None:
        """Open the scene of a figure, once the user agrees where that loses edits, and go on with the parts."""
        c, scene = self._c, self._c.session.scene
        if c.runs.refuses():
            return

        def go_on() -> None:
            open_scene(path)(c)
            self._path, self._waiting = path, [opened(path), *parts]

        self._way_back = ""
        if scene is not None and not is_open(c, path):
            self._way_back = f". {scene.path.name} is in the menu File > Open scene"
        if c.session.edits and self._way_back:
            c.questions.before_losing_edits(path.stem, go_on)
        else:
            go_on()

    def table_1(self) -> None:
        """Measure the open scene as Table 1 does: 512 x 512, depth 10, 100 frames of the path, the kd-tree.

        The scenes of Figures 3 and 4 show nothing in it, and give way to the default scene."""

        def measure(c: Controller) -> None:
            c.runs.experiment_plan = ExperimentPlan({BY_MODES}, verify=True)
            c.runs.start_experiment()
            if self._way_back:
                c.notices.say(f"Table 1 is measured in the default scene{self._way_back}")

        self._way_back = ""
        if is_open(self._c, FIGURE_3) or is_open(self._c, FIGURE_4):
            self._begin(default_scene(), Part(lambda c: c.runs.current is not None, measure))
        else:
            measure(self._c)

    def figure_3(self) -> None:
        """Show a card that the test takes for whole: rays are compared with the left and the upper pixel's alone."""

        def show(c: Controller) -> None:
            c.settings.change(method=BY_MODES, symmetric=False)
            c.session.fix_size(_CARDS, _CARDS)
            c.session.set_draw(view=View.OCCLUSION)
            said = f"Figure 3 in {_CARDS} x {_CARDS} pixels: the card that is hidden on its left is green, too"
            c.notices.say(f"{said}{self._way_back}")

        self._begin(FIGURE_3, Part(lambda c: c.session.draw.view is View.OCCLUSION, show))

    def figure_4(self) -> None:
        """Come near to a triangle whose shadow can be seen only from there, with zoom factors 4 and 64."""

        def test(c: Controller) -> None:
            c.runs.zoom_plan = ZoomPlan(factors="4, 64", size=(SIDE, SIDE))
            c.runs.start_zoom_test()
            c.notices.say(f"Figure 4 is a zoom test of the scene figure4{self._way_back}")

        select = Part(lambda c: c.selection.picked is not None, lambda c: c.selection.select((0.5, 0.5)))
        self._begin(FIGURE_4, select, Part(lambda c: c.runs.current is not None, test))
