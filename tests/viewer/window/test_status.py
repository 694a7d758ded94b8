"""What the status bar and the statistics say in words."""

from __future__ import annotations

from types import SimpleNamespace

from tests.viewer.fakes import make_frame, with_certificates
from tracer.settings import Settings
from viewer.state import terms
from viewer.window.panels.inspector import unanswered
from viewer.window.panels.status import doing, first_picture


def test_a_start_says_one_thing_until_it_is_over() -> None:
    job = SimpleNamespace(title="Compiling the tracer (first start only)", label="compiling shading", fraction=0.25)
    loader = SimpleNamespace(warm_up_job=job, load_job=None, method_job=None, compiles=True)
    c = SimpleNamespace(loader=loader, frame=None, runs=SimpleNamespace(current=None))
    said = {}
    for fraction, label in ((0.25, "compiling shading"), (0.5, "loading shading")):
        job.fraction, job.label = fraction, label
        for c.frame in (None, object()):
            said[c.frame is None, fraction] = doing(c)
    assert said[True, 0.25] == "Compiling the tracer (first start only): 25 %"
    assert said[False, 0.5] == "compiling what makes certificates (first start only): 50 %"
    assert not any("shading" in text or "loading" in text for text in said.values())
    loader.compiles = False
    assert doing(c) == "loading what makes certificates: 50 %"


def test_beams_are_named_where_they_ask() -> None:
    frame = make_frame()
    certified = with_certificates(frame)
    assert terms.asks_by_beams(certified, lamps=True)
    assert certified.statistics.shadow.culled > 0
    assert not terms.asks_by_beams(certified, lamps=False) and not terms.asks_by_beams(frame, lamps=True)


def _idle(**changes: object) -> SimpleNamespace:
    """A controller with a scene and nothing to do, but for what is given."""
    tracing = SimpleNamespace(
        refines_lamps=False,
        certifies=False,
        awaits=False,
        adds_samples=False,
        becoming_finer=False,
        samples_shown=1,
        samples_wanted=4,
    )
    c = SimpleNamespace(
        loader=SimpleNamespace(warm_up_job=None, load_job=None, method_job=None, compiles=False),
        frame=None, runs=SimpleNamespace(current=None), scheduler=tracing, renderer=SimpleNamespace(busy=False),
        motion=SimpleNamespace(under_way=False, is_animating=False),
        session=SimpleNamespace(scene=object(), playing=False, settings=SimpleNamespace(method="lie", samples=1)),
        selection=SimpleNamespace(picked=None, pixel=None), inspector=SimpleNamespace(problem=""),
    )  # fmt: skip
    for name, value in changes.items():
        setattr(tracing if hasattr(tracing, name) else c, name, value)
    return c


def test_without_a_picture_it_is_said_what_goes_on() -> None:
    assert first_picture(_idle()) == "No picture has been traced yet."
    assert first_picture(_idle(renderer=SimpleNamespace(busy=True))) == "Tracing the first picture ..."
    assert first_picture(_idle(session=SimpleNamespace(scene=None))) == "No scene is open"
    job = SimpleNamespace(title="Opening office.aff", label="reading", fraction=0.5)
    loader = SimpleNamespace(warm_up_job=None, load_job=job, method_job=None)
    assert first_picture(_idle(loader=loader)) == "Opening office.aff: reading   (Escape cancels)"


def test_what_was_asked_says_what_it_waits_for() -> None:
    """Nothing moves while samples are added, and an answer comes all the same only after one."""
    for changes, said in (
        ({}, "Tracing its shadow rays ..."),
        ({"adds_samples": True}, "Answered after this sample."),
        ({"refines_lamps": True}, "Answered after the samples of lamps."),
        ({"renderer": SimpleNamespace(busy=True)}, "Answered after this picture."),
        ({"motion": SimpleNamespace(is_animating=True)}, "Answered when nothing moves."),
    ):
        assert unanswered(SimpleNamespace(controller=_idle(**changes))) == said


def test_one_of_what_was_made_is_no_plural() -> None:
    frame = make_frame()
    frame.statistics.certificates = 1
    assert doing(_idle(certifies=True, frame=frame)) == "preparing (cells settled in the last picture: 1)"


def test_a_run_before_its_first_frame_shows_none() -> None:
    run = SimpleNamespace(name="experiment", label="starting", traced=0)
    c = _idle(runs=SimpleNamespace(current=run))
    assert doing(c).startswith("experiment is starting")
    run.traced, run.label = 1, "frame 1 of 5, none"
    assert doing(c).startswith("experiment, traced: frame 1 of 5, none")


def test_modes_that_are_only_looked_at_are_named_as_no_part_of_the_time() -> None:
    for name in ("occlusion testing", "mode setting"):
        label, tip = terms.phase(name, Settings(method="paper", modes=True))
        beside, why = terms.phase(name, Settings(method="none", modes=True))
        assert (label, tip) == terms.PHASES[name]
        assert beside == f"{label} (for display)" and why.startswith(tip) and "no part of the frame's time" in why
        assert terms.phase(name, Settings(method="none")) == terms.PHASES[name]
    assert terms.phase("shading", Settings(modes=True)) == terms.PHASES["shading"]
    assert terms.phase("new", Settings()) == ("new", "")
