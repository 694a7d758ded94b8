"""An EXR holds every buffer to the bit, and how it was made."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.commands import ROOM, Run

OpenEXR = pytest.importorskip("OpenEXR")
SIZE = ("--size", "48x32", "--threads", 1)


def read(path: str) -> tuple[dict[str, np.ndarray], dict]:
    with OpenEXR.File(path, separate_channels=True) as file:
        return {name: channel.pixels.copy() for name, channel in file.channels().items()}, dict(file.header())


def test_all_buffers_are_in_it(run: Run) -> None:
    options = ("--frame", 4, "--warmup", 3, "--method", "paper", "--verify", *SIZE)
    run.ok("render", "room.aff", "-o", "out.exr", "--buffers", "out.npz", *options)
    channels, header = read("out.exr")
    with np.load("out.npz") as kept:
        arrays = {name: kept[name] for name in kept.files}
    for letter, axis in zip("RGB", range(3)):
        assert np.array_equal(channels[letter], arrays["color"][..., axis])
        assert np.array_equal(channels[f"reference.{letter}"], arrays["reference"][..., axis])
    assert np.array_equal(channels["Z"], arrays["depth"]) and np.isinf(channels["Z"]).any()
    for name in ("primitive", "cell", "wrong"):
        assert channels[name].dtype == np.uint32
        assert np.array_equal(channels[name].astype(np.int32), arrays[name])
    for light in range(2):
        for name in ("lit", "due"):
            assert np.array_equal(channels[f"{name}.{light}"], arrays[name][..., light])
        mode = arrays["shadow_mode"][..., light].astype(np.uint32)
        assert np.array_equal(channels[f"shadow_mode.{light}"], np.where(mode == 255, 0xFFFFFFFF, mode))
    assert np.allclose(np.hypot(np.hypot(channels["N.X"], channels["N.Y"]), channels["N.Z"])[channels["Z"] < np.inf], 1)
    data = json.loads(header["shadowcull"])
    assert data["state"]["settings"]["method"] == "paper" and data["state"]["warmup"]["of_path"] == 3
    assert data["statistics"]["shadow"]["due"] > 0


def test_it_can_be_checked(run: Run) -> None:
    run.ok("render", "room.aff", "-o", "full.exr", "--samples", 2, *SIZE)
    run.ok("render", "room.aff", "-o", "half.exr", "--half", *SIZE)
    full, half = read("full.exr")[0], read("half.exr")[0]
    assert full["R"].dtype == full["Z"].dtype == half["Z"].dtype == np.float32 and half["R"].dtype == np.float16
    out = run.ok("check", "full.exr", "half.exr")
    assert out.count("true: 48 × 32, the colours bit for bit") == 2
    Path("room.aff").write_text(ROOM.replace("l -3 4 2", "l -3 3 2"))
    Path("none.exr").write_bytes(b"none")
    code, out, said = run("check", "full.exr", "none.exr")
    assert code == 1 and "the scene's lights" in out and "none.exr: cannot be read" in said
