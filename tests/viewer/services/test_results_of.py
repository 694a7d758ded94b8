"""Results stay when another scene is opened, and then they say that they are of the one before."""

from __future__ import annotations

from datetime import datetime

from tests.viewer.fakes import make_frame, make_scene
from tracer.experiments import zoom
from tracer.experiments.experiment import Experiment
from tracer.experiments.zoom import ZoomTest
from tracer.frame import Settings
from viewer.services.runs import described


def test_results_name_their_scene_and_that_it_is_not_the_one_that_is_open():
    kitchen, office = (make_scene(path=f"scenes/{name}.aff") for name in ("kitchen", "office"))
    run = Experiment(kitchen, Settings(width=64, height=48, accelerator="kdtree"), ["paper"], [0.0] * 5)
    run.began = datetime(2026, 1, 2, 14, 3)
    rest = ", 64 x 48, 0 of 5 frames, kdtree, begun 2026-01-02 14:03"
    assert described(run, kitchen) == (f"kitchen.aff{rest}", False)
    assert described(run, office) == (f"kitchen.aff (not office.aff, which is open){rest}", True)
    again = make_scene(path="scenes/kitchen.aff")
    assert described(run, again) == (f"kitchen.aff before it was edited or reloaded{rest}", True)
    assert described(run, None) == (f"kitchen.aff{rest}", True)


def test_a_zoom_test_names_its_primitive_and_the_time_of_today():
    scene = make_scene()
    test = ZoomTest(scene, Settings(width=64, height=64), zoom.aim(make_frame(), 3))
    said, elsewhere = described(test, scene)
    assert not elsewhere
    assert said == f"scene.aff, 64 x 64, towards primitive 3, begun {test.began:%H:%M}"
