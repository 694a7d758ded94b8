"""The results of a sweep on the disk: a row for each frame, as Parquet, in files that are whole or absent.

What arrives together is written together, at once, as a part of its own; parts are merged at the end.  A crash of
anything loses nothing that was written, and leaves at most rows that are there twice, which count once.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import pyarrow as pa
import pyarrow.parquet as pq
from filelock import FileLock, Timeout

from tracer.experiments.experiment import FIGURES
from tracer.experiments.study import ASPECTS
from tracer.settings import Settings
from tracer.util.setting import settings_of

_COUNTERS = [name for name in FIGURES if name != "frame_seconds"]
_TYPES: dict[type, pa.DataType] = {bool: pa.bool_(), int: pa.int32(), float: pa.float64(), str: pa.string()}
_FIELDS: dict[str, pa.DataType] = {
    "task": pa.string(),
    "scene": pa.string(),
    "scene_code": pa.string(),
    "method": pa.string(),
    "width": pa.int32(),
    "height": pa.int32(),
    **{one.name: _TYPES[one.kind] for one in settings_of(Settings) if one.name in ASPECTS},
    "certificates": pa.int64(),  # as many as one likes
    "seed": pa.int64(),
    "shake": pa.float64(),
    "warmup": pa.int32(),
    "frame": pa.int32(),
    "path_frames": pa.int32(),
    "time": pa.float64(),
    **{name: pa.int64() for name in _COUNTERS},
    "frame_seconds": pa.float64(),
    "processor_seconds": pa.float64(),
    "picture": pa.string(),
    "repeats": pa.bool_(),
    "version": pa.string(),
    "tracer": pa.string(),
    "host": pa.string(),
    "process": pa.int64(),
    "processor": pa.string(),
    "cores": pa.int32(),
    "system": pa.string(),
    "python": pa.string(),
    "numpy": pa.string(),
    "numba": pa.string(),
    "finished": pa.timestamp("ms", "UTC"),
}
SCHEMA = pa.schema(list(_FIELDS.items()))
RESULTS, PARTS, STUDY, LOCK = "results.parquet", "parts", "study.json", ".lock"
_UNFINISHED = ".unfinished"
Key = tuple[str, int]
"""A task and the number of a frame."""


class Store:
    """The folder of a sweep's results.  Only one process may write to it: who `lock`s it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._lock = FileLock(folder / LOCK)

    @property
    def results(self) -> Path:
        """The file of all results, once they are merged."""
        return self.folder / RESULTS

    def lock(self) -> None:
        """Make the folder, and keep others from writing to it until `unlock`; raises OSError in one line."""
        try:
            (self.folder / PARTS).mkdir(parents=True, exist_ok=True)
            self._lock.acquire(timeout=0)
            for left in (self.folder / PARTS).glob(f"*{_UNFINISHED}"):  # by a sweep that was killed
                left.unlink()
        except Timeout:
            raise OSError(f"{self.folder}: another sweep writes to it; wait, or give another folder") from None
        except OSError as error:
            raise OSError(f"{self.folder}: no folder for results: {error.strerror or error}") from None

    def unlock(self) -> None:
        """Let others write."""
        self._lock.release()

    # --- the study that they are of ---------------------------------------------------------------

    def study(self) -> dict[str, Any] | None:
        """What the results are of; None where there are none.  Raises OSError in one line."""
        path = self.folder / STUDY
        try:
            data = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            if self.results.exists() or any(self._parts()):
                raise OSError(f"{path}: missing, so that nobody knows what the results are of") from None
            return None
        except (OSError, ValueError) as error:
            raise OSError(f"{path}: cannot be read: {error}") from None
        if not isinstance(data, dict):
            raise OSError(f"{path}: damaged")
        return data

    def set_study(self, data: dict[str, Any]) -> None:
        """Say what the results are of; raises OSError in one line."""
        text = json.dumps(data, indent=1, ensure_ascii=False)
        self._write(self.folder / STUDY, lambda file: file.write(text.encode()))

    # --- rows -------------------------------------------------------------------------------------

    def read(self) -> pa.Table:
        """All rows, each frame once; raises OSError, in one line, for a damaged file."""
        files = [*([self.results] if self.results.exists() else []), *self._parts()]
        tables = [self._read(path) for path in files]
        table = pa.concat_tables(tables) if tables else SCHEMA.empty_table()
        seen: set[Key] = set()
        first = []
        for number, key in enumerate(keys_of(table)):
            if key not in seen:
                seen.add(key)
                first.append(number)
        return table if len(first) == len(table) else table.take(first)

    def add(self, rows: Sequence[dict[str, Any]]) -> Path:
        """Write rows, whole, now; raises OSError in one line."""
        path = self.folder / PARTS / f"{time.time_ns():020d}-{os.getpid()}.parquet"
        self._write_table(path, pa.Table.from_pylist(list(rows), SCHEMA))
        return path

    def merge(self) -> None:
        """Put all rows into one file, in an order that does not depend on when they were traced."""
        parts = self._parts()
        if not parts:
            return
        order = ("scene", "width", "height", "method", "task", "frame")
        self._write_table(self.results, self.read().sort_by([(name, "ascending") for name in order]))
        for path in parts:
            path.unlink(missing_ok=True)

    def clear(self) -> None:
        """Remove all results."""
        for path in [self.results, self.folder / STUDY, *self._parts()]:
            path.unlink(missing_ok=True)

    def _parts(self) -> list[Path]:
        return sorted((self.folder / PARTS).glob("*.parquet"))

    def _write_table(self, path: Path, table: pa.Table) -> None:
        self._write(path, lambda file: pq.write_table(table, file, compression="zstd"))

    def _write(self, path: Path, write: Callable[[BinaryIO], object]) -> None:
        """Let `write` fill a file that takes its name once it is whole and on the disk."""
        unfinished = self.folder / PARTS / f"{path.name}{_UNFINISHED}"
        try:
            with unfinished.open("wb") as file:
                write(file)
                file.flush()
                os.fsync(file.fileno())
            os.replace(unfinished, path)
        except OSError as error:
            raise OSError(f"{path}: not written: {error.strerror or error}") from None

    def _read(self, path: Path) -> pa.Table:
        try:
            return _with_all_settings(pq.read_table(path, partitioning=None)).cast(SCHEMA)
        except (OSError, ValueError, KeyError) as error:  # pyarrow's own are of these kinds
            text = " ".join(str(error).split())[:200]
            raise OSError(f"{path}: damaged; remove it, and its frames are traced again ({text})") from None


def _with_all_settings(table: pa.Table) -> pa.Table:
    """Rows that were kept before a setting could vary have its usual value."""
    for name in ASPECTS:
        if name not in table.column_names:
            usual = pa.array([getattr(Settings(), name)] * len(table), _FIELDS[name])
            table = table.append_column(name, usual)
    return table.select(SCHEMA.names)


def keys_of(table: pa.Table) -> list[Key]:
    """The task and the frame of each row."""
    return list(zip(table["task"].to_pylist(), table["frame"].to_pylist()))
