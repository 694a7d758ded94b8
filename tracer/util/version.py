"""Which version of the program this is."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path


def program_version() -> str:
    try:
        return version("shadowcull")
    except PackageNotFoundError:
        return "(not installed)"


@cache
def tracer_code() -> str:
    """A short code of the sources that trace: two programs with the same one trace alike, whatever their version."""
    root, digest = Path(__file__).parents[1], hashlib.blake2b(digest_size=8)
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()
