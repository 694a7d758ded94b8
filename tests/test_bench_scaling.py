"""The benchmarks of memory, growth and the window: that they run, can be true, and that their checks can fail."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.bench import growth, memory, window_times
from tests.bench.meshes import bumpy_sphere, frequency_for
from tests.bench.window_server import STATES
from viewer.util.resources import scene_path

DEFAULT = str(scene_path(None))


@pytest.mark.parametrize("frequency", [1, 2, 7])
def test_a_bumpy_sphere_is_closed_and_as_large_as_asked(frequency: int) -> None:
    corners = bumpy_sphere(frequency)
    assert corners.shape == (20 * frequency**2, 3, 3) and corners.dtype == np.float32
    assert frequency_for(len(corners)) == frequency
    edges = np.concatenate([corners[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))]).round(5) + 0.0
    there, back = ({edge.tobytes() for edge in way} for way in (edges, edges[:, ::-1]))
    assert len(there) == 30 * frequency**2 * 2 and there == back  # each edge once in either direction
    volume = np.einsum("nx,nx->n", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert 2.0 < volume < 5.0  # wound counterclockwise from outside


# Of meshes on which nothing is measured.
SMALLER = ("--fewest", "4000", "--most", "40000", "--repeats", "1")


def run_growth(tmp_path: Path, *arguments: str) -> tuple[int, dict]:
    out = tmp_path / "out" / "growth.json"
    small = ["--fewest", "15000", "--most", "150000", "--sizes", "4", "--side", "96", "--repeats", "3"]
    code = growth.main([*small, *arguments, "--json", str(out), "--plot", str(tmp_path / "out" / "growth.png")])
    return code, json.loads(out.read_text())


def test_growth_is_a_logarithms(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, report = run_growth(tmp_path)  # times may be anything on a machine that has other work
    costs = report["costs"]
    assert costs["faults"] == []
    assert costs["triangles"] == sorted(costs["triangles"]) and len(costs["triangles"]) == 4
    for kind in growth.KINDS:
        assert costs["rays"][kind] > 1000
        steps = [cost["steps"] for cost in costs[kind]]
        assert steps == sorted(steps) and steps[-1] < 4.0 * steps[0]
        assert all(cost["ns"] > 1.0 and cost["tests"] > 0.0 for cost in costs[kind])
    fitted = report["fits"]["incoherent"]["steps"]
    assert fitted["r2"] > 0.9 and 0.0 < fitted["power"] < 0.2
    assert (tmp_path / "out" / "growth.png").stat().st_size > 10_000
    assert "log2(triangles)" in capsys.readouterr().out


def test_a_fit_tells_a_logarithm_from_a_power() -> None:
    triangles = [10_000 * 2**k for k in range(8)]
    logarithm = growth.fit(triangles, [3.0 + 0.5 * k for k in range(8)])
    assert 0.0 < logarithm.pop("power") < 0.2
    assert logarithm == pytest.approx({"at_least": 3.0, "doubling": 0.5, "r2": 1.0})
    power = growth.fit(triangles, [2.0**k for k in range(8)])
    assert power["power"] == pytest.approx(1.0) and power["r2"] < 0.8


def test_growth_that_is_none_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    ask, asked = growth.ask, 0

    def dearer(*arguments):
        nonlocal asked
        asked += 1
        cost, hits = ask(*arguments)
        return cost | {"steps": 2.0**asked, "ns": 1000.0 / asked}, hits

    monkeypatch.setattr(growth, "ask", dearer)
    code, _ = run_growth(tmp_path, *SMALLER)
    assert code == 1
    told = capsys.readouterr().err
    assert "incoherent rays, steps: a logarithm explains only" in told
    assert "primary rays cost more than incoherent ones" in told


def test_rays_that_find_another_surface_fail_growth(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    made = growth.bumpy_sphere
    monkeypatch.setattr(growth, "bumpy_sphere", lambda n: made(n) * np.float32(1.0 + 0.01 * (n % 7)))
    assert run_growth(tmp_path, *SMALLER)[0] == 1
    assert "find the same surface" in capsys.readouterr().err


def test_memory_is_measured(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out" / "memory.json"
    assert memory.main([DEFAULT, "--triangles", "20000", "--size", "128", "--json", str(out)]) == 0
    scene, mesh = json.loads(out.read_text())["scenes"]
    for result in (scene, mesh):
        assert 50e6 < result["libraries"] < 500e6
        assert result["peak"] >= result["resident"] > 128 * 128 * 32  # a frame's buffers at least
        assert result["build_seconds"] > 0.0 and result["seen"] > 0.1
    assert mesh["triangles"] == pytest.approx(20_000, rel=0.05)
    assert 100 < mesh["peak"] / mesh["triangles"] < 3000  # bytes a triangle
    assert "mesh.stl" in capsys.readouterr().out


def test_a_scene_that_is_not_there_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert memory.main([str(tmp_path / "no.aff"), "--triangles", "0", "--json", str(tmp_path / "m.json")]) == 1
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


@pytest.mark.gui
def test_the_window_is_timed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out" / "window.json"
    options = ["--seconds", "0.7", "--size", "800x600", "--no-cold", "--no-rehearsal", "--json", str(out)]
    assert window_times.main([str(scene_path("figure4")), *options]) == 0
    (window,) = json.loads(out.read_text())["windows"]
    assert window["faults"] == []
    seen = window["seen"]
    assert 0.1 < seen["window"] < seen["first picture"] <= seen["full picture"] < 60.0
    assert set(window["frames"]) == set(STATES)
    for state in ("tracing", "moving", "at rest"):
        summary = window_times.summary(window["frames"][state])
        assert 0.2 < summary["own"] <= summary["median"] <= summary["high"] <= summary["longest"] < 5000.0
        assert 0.0 <= window["others"][state] < 1024.0
    assert len(window["frames"]["moving"]) > 5 and window["traced"]["tracing"] >= 1
    printed = capsys.readouterr().out
    assert "the window's frames" in printed and "From the start of the process" in printed


def test_a_window_that_shows_nothing_is_not_trusted() -> None:
    nothing = {"frames": {state: [] for state in STATES}, "traced": dict.fromkeys(STATES, 0), "kernels": "cold"}
    found = window_times.faults_of(nothing | {"seen": {"window": 1.0}})
    assert "no full picture was seen" in found and "tracing: nothing was traced" in found
