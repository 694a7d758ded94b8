"""Small scenes from strings."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tracer.scene.aff import load_aff
from tracer.scene.model import Scene


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """write(text, name="scene.aff", **other files by stem) -> path of the first file."""

    def write(text: str | bytes, name: str = "scene.aff", **others: str | bytes) -> Path:
        for stem, content in {name: text, **{f"{k}.aff": v for k, v in others.items()}}.items():
            (tmp_path / stem).write_bytes(content if isinstance(content, bytes) else content.encode())
        return tmp_path / name

    return write


@pytest.fixture
def read(write: Callable[..., Path]) -> Callable[..., Scene]:
    """read(text, **other files by stem) -> Scene."""
    return lambda text, **others: load_aff(write(text, **others))
