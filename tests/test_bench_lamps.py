"""The benchmark of lamps: that it runs, tells what it measured, and that its check can fail."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.bench import lamps
from tracer.renderer import Renderer

SMALL = ["default", "--radius", "0.2", "--samples", "4", "--frames", "3", "--size", "48", "--threads", "1"]


def run(tmp_path: Path) -> tuple[int, dict]:
    out = tmp_path / "out" / "lamps.json"
    code = lamps.main([*SMALL, "--methods", "certified", "paper", "--json", str(out)])
    return code, json.loads(out.read_text())["runs"][0]


def test_it_tells_speed_ups_and_what_was_known(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, found = run(tmp_path)
    assert code == 0 and found["differ"] == [] and (found["lamp_radius"], found["lamp_samples"]) == (0.2, 4)
    assert set(found["speed_up"]) == {"certified", "paper", "free"} and found["shadow_rays"] > 3 * 48 * 48
    for name, times in found["seconds"].items():
        assert len(times) == 3 and min(times) > 0, name
    assert found["speed_up"]["paper"]["total"] == pytest.approx(
        sum(found["seconds"]["none"]) / sum(found["seconds"]["paper"])
    )
    assert 0 < found["known"]["paper"] < 1 and found["speed_up"]["paper"]["low"] > 0
    shown = capsys.readouterr().out
    assert "default.aff" in shown and "free" in shown and "100%" in shown


def test_a_picture_that_differs_is_a_fault(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    render = Renderer.render

    def wrong(self: Renderer, time: float, *more, **options):
        frame = render(self, time, *more, **options)
        frame.color[0, 0] += self.settings.method == "certified"
        return frame

    monkeypatch.setattr(Renderer, "render", wrong)
    code, found = run(tmp_path)
    assert code == 1 and found["differ"] == [["certified", number] for number in (0, 66, 133)]  # of 200, evenly
