"""Damages saved pictures and studies field by field: each gives what it holds, or one clear line, and nothing else."""

from __future__ import annotations

import json
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, PngImagePlugin

from tests.fuzz.seeds import AFF
from tracer.experiments.study import read_study
from tracer.scene.load import load_scene
from tracer.scene.model import Camera
from viewer.output import capture
from viewer.state import codec
from viewer.state.view_state import ViewState

SCENE = "a.aff"
STUDY = {
    "scenes": [SCENE],
    "methods": ["none", "paper"],
    "title": "of fields",
    "sizes": ["8x8", "16x8"],
    "seeds": [1, 2],
    "shake": 0.1,
    "warmup": 2,
    "folders": ["."],
    "path": {"frames": 8, "first": 1, "last": 5},
    "settings": {"depth": [2, 10], "verify": True, "lamp_radius": 0.5, "zoom_factor": 4.0, "accelerator": "kdtree"},
}
VALUES: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 2**31, 2**64, -(10**30), 0.5, 1e308, -1e-300, float("inf"), float("nan"), "", "x",
    "none", "../..", "/dev/zero", "\x1b]0;x\x07", "a\0b", "x" * 5000, "8x8x8", "99999x99999", [], {}, [[]],
    [1, "a", None], {"a": 1}, [0] * 1000, list(range(3000)),
)  # fmt: skip


def of_picture() -> dict[str, Any]:
    """What a saved picture of the scene carries."""
    state = ViewState(SCENE, camera=Camera((0.0, 1.0, 4.0), (0.0, 0.0, -1.0)))
    return json.loads(capture.Carried(codec.state_to_json(state, of_picture=True), size=(8, 8)).text())


def changed(data: Any, rng: np.random.Generator) -> Any:
    """A copy of nested data with one to three fields that are another value, left out, deeper, or of another name."""
    data = json.loads(json.dumps(data))
    for _ in range(rng.integers(1, 4)):
        holder, key = _some_place(data, rng)
        kind = rng.integers(10)
        if kind == 0:
            del holder[key]
        elif kind == 1:
            for _ in range(int(rng.choice([1, 30, 100]))):
                holder[key] = [holder[key]] if rng.integers(2) else {"a": holder[key]}
        elif kind == 2 and isinstance(holder, dict):
            holder[str(rng.choice(["", "x", "view", "x" * 5000, "\x1b[31m", "__class__"]))] = holder.pop(key)
        else:
            holder[key] = deepcopy(VALUES[rng.integers(len(VALUES))])
    return data


def _some_place(data: Any, rng: np.random.Generator) -> tuple[Any, Any]:
    """A holder inside, and one of its keys or numbers; now and then one that holds others itself."""
    while True:
        keys = list(data) if isinstance(data, dict) else list(range(len(data)))
        key = keys[rng.integers(len(keys))]
        if not isinstance(data[key], dict | list) or not data[key] or rng.integers(5) == 0 or len(data[key]) > 9_999:
            return data, key
        data = data[key]


def toml(value: Any) -> str:
    """A value as TOML has it, in one line; None is a word that it does not have."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {toml(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return str(value).lower() if isinstance(value, float) else json.dumps(value)


def read_changed(folder: Path, rng: np.random.Generator) -> str:
    """Change a picture or a study, read it, and return its error's text, or nothing; all else is raised."""
    kind: Callable[[Path, np.random.Generator], None] = (_picture, _study)[rng.integers(2)]
    (folder / SCENE).write_bytes(AFF)
    try:
        kind(folder, rng)
    except (ValueError, OSError) as error:
        return str(error) or type(error).__name__
    return ""


def _picture(folder: Path, rng: np.random.Generator) -> None:
    text, info, path = json.dumps(changed(of_picture(), rng)), PngImagePlugin.PngInfo(), folder / "fields.png"
    info.add_itxt(capture.CHUNK, text)
    Image.new("RGB", (8, 8)).save(path, pnginfo=info)
    capture.read(path)


def _study(folder: Path, rng: np.random.Generator) -> None:
    path = folder / "fields.toml"
    lines = [f"{json.dumps(key)} = {toml(value)}\n" for key, value in changed(STUDY, rng).items()]
    path.write_text("".join(lines))
    study = read_study(path, {})
    for name, scene in study.scenes.items():
        study.tasks(name, load_scene(scene), "")
