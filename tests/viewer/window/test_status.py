"""What the status bar and the statistics say in words."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from tests.viewer.fakes import make_frame, with_certificates
from tracer.settings import Settings
from viewer.state import terms
from viewer.window.panels.inspector import unanswered
from viewer.window.panels.status import doing, first_picture


def job(title: str, label: str = "", fraction: float = 0.5) -> SimpleNamespace:
    return SimpleNamespace(title=title, label=label, fraction=fraction)


def idle(**changes: object) -> SimpleNamespace:
    """A controller with a scene and nothing to do, but for what is given of it, its loader and its scheduler."""
    off = dict.fromkeys(("refines_lamps", "certifies", "awaits", "adds_samples", "becoming_finer"), False)
    tracing = SimpleNamespace(**off, samples_shown=1, samples_wanted=4)
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


def run(traced: int, label: str) -> SimpleNamespace:
    return SimpleNamespace(current=SimpleNamespace(name="experiment", label=label, traced=traced))


@pytest.mark.parametrize(
    ("state", "said"),
    [
        ({"warm_up_job": KERNELS}, "Compiling the tracer (first start only): 50 %"),
        ({"warm_up_job": KERNELS, "compiles": True, "frame": FRAME},
         "compiling what makes certificates (first start only): 50 %"),
        ({"warm_up_job": KERNELS, "frame": FRAME}, "loading what makes certificates: 50 %"),
        ({"runs": run(0, "starting")}, "experiment is starting   (Escape stops it)"),
        ({"runs": run(1, "frame 1 of 5, none")}, "experiment, traced: frame 1 of 5, none   (Escape stops it)"),
        ({"certifies": True, "frame": FRAME}, "preparing (cells settled in the last picture: 1)"),
        ({}, "idle"),
    ],
)  # fmt: skip
def test_the_bar_says_one_thing_that_goes_on(state: dict[str, object], said: str) -> None:
    assert doing(idle(**state)) == said


@pytest.mark.parametrize(
    ("state", "said"),
    [
        ({}, "No picture has been traced yet."),
        ({"renderer": BUSY}, "Tracing the first picture ..."),
        ({"session": NO_SCENE}, "No scene is open"),
        ({"load_job": job("Opening office.aff", "reading")}, "Opening office.aff: reading   (Escape cancels)"),
    ],
)
def test_without_a_picture_it_is_said_what_goes_on(state: dict[str, object], said: str) -> None:
    assert first_picture(idle(**state)) == said


@pytest.mark.parametrize(
    ("state", "said"),
    [
        ({}, "Tracing its shadow rays ..."),
        ({"adds_samples": True}, "Answered after this sample."),
        ({"refines_lamps": True}, "Answered after the samples of lamps."),
        ({"renderer": BUSY}, "Answered after this picture."),
        ({"motion": SimpleNamespace(is_animating=True)}, "Answered when nothing moves."),
    ],
)
def test_what_was_asked_says_what_it_waits_for(state: dict[str, object], said: str) -> None:
    assert unanswered(SimpleNamespace(controller=idle(**state))) == said


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
