"""What the status bar and the statistics say in words."""

from __future__ import annotations

from types import SimpleNamespace

from tests.viewer.fakes import make_frame, with_certificates
from viewer.state import terms
from viewer.window.panels.status import doing


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
