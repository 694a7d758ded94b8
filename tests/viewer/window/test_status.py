"""What the status bar, the statistics and the panel Culling say in words."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from tests.viewer.fakes import make_frame, with_certificates
from tracer.settings import Settings
from viewer.services.frame_scheduler import Activity
from viewer.state import terms
from viewer.state.draw_options import DrawOptions
from viewer.state.views import View
from viewer.window.panels.culling import trust, wrong_answers
from viewer.window.panels.inspector import unanswered
from viewer.window.panels.status import doing, first_picture
from viewer.window.widgets import ERROR


def job(title: str, label: str = "", fraction: float = 0.5) -> SimpleNamespace:
    return SimpleNamespace(title=title, label=label, fraction=fraction)


def idle(**changes: object) -> SimpleNamespace:
    """A controller with a scene and nothing to do, but for what is given of it, its loader and its scheduler."""
    tracing = SimpleNamespace(activity=Activity.RESTING, samples_shown=1, samples_wanted=4)
    loader = SimpleNamespace(warm_up_job=None, load_job=None, method_job=None, compiles=False)
    c = SimpleNamespace(
        loader=loader, frame=None, runs=SimpleNamespace(current=None), scheduler=tracing,
        renderer=SimpleNamespace(busy=False), motion=SimpleNamespace(under_way=False, is_animating=False),
        session=SimpleNamespace(scene=object(), playing=False, settings=SimpleNamespace(method="lie", samples=1)),
        selection=SimpleNamespace(picked=None, pixel=None), inspector=SimpleNamespace(problem=""),
    )  # fmt: skip
    for name, value in changes.items():
        setattr(next((part for part in (tracing, loader) if hasattr(part, name)), c), name, value)
    return c


BUSY, NO_SCENE = SimpleNamespace(busy=True), SimpleNamespace(scene=None)
FRAME = make_frame()
FRAME.statistics.certificates = 1
KERNELS = job("Compiling the tracer (first start only)", "compiling shading")


def answers(c: SimpleNamespace) -> str:
    return unanswered(SimpleNamespace(controller=c))


def run(traced: int, label: str) -> SimpleNamespace:
    return SimpleNamespace(current=SimpleNamespace(name="experiment", label=label, traced=traced))


@pytest.mark.parametrize(
    ("says", "state", "said"),
    [
        (doing, {"warm_up_job": KERNELS}, "Compiling the tracer (first start only): 50 %"),
        (doing, {"warm_up_job": KERNELS, "compiles": True, "frame": FRAME},
         "compiling the kernels of other methods (first start only): 50 %"),
        (doing, {"warm_up_job": KERNELS, "frame": FRAME}, "loading the kernels of other methods: 50 %"),
        (doing, {"runs": run(0, "starting")}, "experiment: starting   (Escape stops it)"),
        (doing, {"runs": run(1, "frame 1 of 5, none")}, "experiment: frame 1 of 5, none is traced   (Escape stops it)"),
        (doing, {"activity": Activity.CERTIFYING, "frame": FRAME},
         "making certificates (cells settled in the last picture: 1)"),
        (doing, {}, "idle"),
        (first_picture, {}, "No picture has been traced yet."),
        (first_picture, {"renderer": BUSY}, "Tracing the first picture ..."),
        (first_picture, {"session": NO_SCENE}, "No scene is open"),
        (first_picture, {"load_job": job("Opening office.aff", "reading")},
         "Opening office.aff: reading   (Escape cancels)"),
        (answers, {}, "Tracing its shadow rays ..."),
        (answers, {"activity": Activity.ADDING_SAMPLES}, "Answered after this sample."),
        (answers, {"activity": Activity.SAMPLING_LAMPS}, "Answered after the samples of lamps."),
        (answers, {"renderer": BUSY}, "Answered after this picture."),
        (answers, {"motion": SimpleNamespace(is_animating=True)}, "Answered when nothing moves."),
    ],
)  # fmt: skip
def test_the_bar_the_empty_picture_and_the_inspector_say_what_goes_on(says, state: dict[str, object], said: str):
    assert says(idle(**state)) == said


def test_beams_are_named_where_they_ask() -> None:
    frame = make_frame()
    certified = with_certificates(frame)
    assert terms.asks_by_beams(certified, lamps=True)
    assert not terms.asks_by_beams(certified, lamps=False) and not terms.asks_by_beams(frame, lamps=True)


def test_modes_that_are_only_looked_at_are_named_as_no_part_of_the_time() -> None:
    for name in ("occlusion testing", "mode setting"):
        label, tip = terms.phase(name, Settings(method="paper", modes=True))
        beside, why = terms.phase(name, Settings(method="none", modes=True))
        assert (label, tip) == terms.PHASES[name] == terms.phase(name, Settings(method="none"))
        assert beside == f"{label} (for display)" and why.startswith(tip) and "no part of the frame's time" in why
    assert terms.phase("shading", Settings(modes=True)) == terms.PHASES["shading"]
    assert terms.phase("new", Settings()) == ("new", "")


# --- beside the method ---------------------------------------------------------------------------------


def shown(method: str, **more: object) -> SimpleNamespace:
    """A controller with a frame by a method, which is the one that is chosen."""
    settings = Settings(16, 8, method=method, **more)
    session = SimpleNamespace(settings=settings, draw=DrawOptions(View.DIFFERENCE))
    scheduler = SimpleNamespace(inputs=SimpleNamespace(settings=settings))
    return SimpleNamespace(frame=make_frame(settings), scheduler=scheduler, session=session,
                           runs=SimpleNamespace(current=None))  # fmt: skip


def test_wrong_answers_are_those_of_the_method_that_is_shown() -> None:
    c = shown("paper", verify=True)
    text, color = wrong_answers(c)
    assert text.startswith("3 wrong answers (") and color == ERROR
    c.session.settings = Settings(16, 8, method="paper")
    assert wrong_answers(c)[0] == f"{text} (verified for the view Difference)", "the box Verify is not ticked"
    c.runs.current = SimpleNamespace(name="zoom test")
    text, color = wrong_answers(c)
    assert text == "The panel of the zoom test shows its wrong answers." and color != ERROR
    c.runs.current, c.scheduler.inputs.settings = None, Settings(16, 8, method="auto", verify=True)
    assert wrong_answers(c) is None


def test_below_a_method_stands_what_it_trusts_whether_it_is_exact_and_what_it_does_now() -> None:
    first, second = trust(shown("paper+cache")).split(" Occluder cache: ")
    assert first.startswith("Paper: Trusts ") and "Wrong now and then." in first and second.endswith("as the method.")
    c = shown("auto")
    c.frame.statistics.decision = "Every shadow ray is traced."
    assert trust(c).endswith(" Exact. Every shadow ray is traced.")
    c.session.settings = Settings(16, 8, method="certified")
    assert "Every shadow ray" not in trust(c), "the picture is another method's"
