"""A study as a TOML file, read with care: whatever is wrong with it is one line that names the file, the line in it,
the key, and what to do."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Callable, Mapping
from itertools import product
from pathlib import Path
from typing import Any, TypeVar

from tracer.experiments.study import ASPECTS, Study
from tracer.geometry.accelerators import ACCELERATORS
from tracer.method import Method
from tracer.scene.files import read_regular
from tracer.settings import LIGHT_BUFFER_SIDES, MAX_NODES, Settings
from tracer.similar import did_you_mean, did_you_mean_file, similar

T = TypeVar("T")
KEYS = ("title", "scenes", "methods", "sizes", "seeds", "shake", "warmup", "folders", "settings", "path")
PATH_KEYS = ("frames", "first", "last")
MOST_BYTES = 1 << 20
MOST_SETTINGS = 10_000
_FALLBACK = {"verify": False, "accelerator": "kdtree"}  # as in `bench`


class StudyError(ValueError):
    """A study cannot be read; the message is one line."""


def read_study(path: Path, own_scenes: Mapping[str, Path]) -> Study:
    """Read a study; `own_scenes` are those that it may name.  Raises StudyError and OSError, in one line."""
    try:
        text = read_regular(path, MOST_BYTES).decode("utf-8")
        return _Reader(path, text, tomllib.loads(text), own_scenes).study()
    except OSError as error:
        if isinstance(error, FileNotFoundError):
            raise OSError(f"{path}: no such file{did_you_mean_file(path)}") from None
        raise OSError(f"{path}: no study can be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise StudyError(f"{path}: no study: it is not text in UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        place = re.search(r" \(at line (\d+), column (\d+)\)$", str(error))
        where = f", line {place[1]}, column {place[2]}" if place else ""
        message = str(error)[: place.start()] if place else str(error).removesuffix(" (at end of document)")
        raise StudyError(f"{path}{where}: not TOML: {message}") from None


class _Reader:
    """Takes one value after another, and knows where each stands."""

    def __init__(self, path: Path, text: str, data: dict[str, Any], own_scenes: Mapping[str, Path]) -> None:
        self._own_scenes = own_scenes
        self._path, self._lines, self._data = path, text.splitlines(), data

    def study(self) -> Study:
        self._check_keys(self._data, KEYS, "")
        settings, path = (self._table(name) for name in ("settings", "path"))
        self._check_keys(settings, ASPECTS, "settings")
        self._check_keys(path, PATH_KEYS, "path")
        scenes = self._several("scenes", str, "names of scenes that come with the program, or files")
        methods = self._several("methods", self._method, "names of methods")
        sizes = (
            self._several("sizes", self._size, 'sizes, such as "640x480"') if "sizes" in self._data else [(512, 512)]
        )
        folders = self._several("folders", str, "folders", required=False)
        aspects = [self._aspect(name, settings) for name in ASPECTS]
        if math.prod(len(values) for values in [sizes, *aspects]) > MOST_SETTINGS:
            raise self._wrong("settings", "", f"more than {MOST_SETTINGS:,} combinations; leave some out")
        chosen = []
        for size, *values in product(sizes, *aspects):
            try:
                given = {name: value for name, value in zip(ASPECTS, values) if value is not None}
                chosen.append(Settings(width=size[0], height=size[1], method="none", **given).validated())
            except ValueError as error:
                name = next((n for n in ASPECTS if n in str(error)), "")
                raise self._wrong(name, "settings" if name else "", str(error)) from None
        return Study(
            path=self._path,
            title=self._one("title", "", self._data, str, "a text", self._path.stem),
            scenes={name: self._scene(name) for name in scenes},
            methods=tuple(methods),
            settings=tuple(chosen),
            seeds=tuple(
                self._several("seeds", self._whole(0, 2**31 - 1), "whole numbers from 0", required=False) or [0]
            ),
            shake=self._one("shake", "", self._data, self._number(0.0, 1.0), "a number from 0 to 1", 0.0),
            path_frames=self._one("frames", "path", path, self._whole(1, 1_000_000), "a whole number from 1", None),
            first=self._one("first", "path", path, self._whole(0, 1_000_000), "the number of a frame", 0),
            last=self._one("last", "path", path, self._whole(0, 1_000_000), "the number of a frame", None),
            warmup=self._one("warmup", "", self._data, self._whole(0, 100_000), "a whole number from 0", None),
            folders=tuple(self._beside(folder) for folder in folders),
        )

    # --- values -----------------------------------------------------------------------------------

    def _aspect(self, name: str, table: dict[str, Any]) -> list[Any]:
        """The values of a setting, one or several; None stands for the usual one."""
        kinds: dict[str, tuple[Callable[[Any], Any], str]] = {
            "symmetric": (_truth, "true or false"),
            "verify": (_truth, "true or false"),
            "accelerator": (_accelerator, " or ".join(f'"{name}"' for name in ACCELERATORS)),
            "depth": (self._whole(0, 100), "a whole number from 0 to 100"),
            "lamp_samples": (self._whole(1, 1 << 20), "a whole number from 1"),
            "certificates": (self._whole(0, 1 << 40), "a whole number from 0"),
            "lightcuts_error": (self._number(0.0, 1e9), "a number from 0, such as 0.02 for 2 %"),
            "lightcuts_nodes": (self._whole(1, MAX_NODES), f"a whole number from 1 to {MAX_NODES}"),
            "light_buffer_side": (self._one_of(LIGHT_BUFFER_SIDES), f"one of {_listed(LIGHT_BUFFER_SIDES)}"),
        }
        parse, what = kinds.get(name, (self._number(0.0, 1e12), "a number from 0"))
        if name not in table:
            return [_FALLBACK.get(name)]
        value = table[name]
        if not isinstance(value, list):
            return [self._one(name, "settings", table, parse, f"{what}, or a list of such", None)]
        return self._list(name, "settings", value, parse, f"each is {what}")

    def _method(self, value: Any) -> str:
        if not isinstance(value, str):
            raise TypeError
        return str(Method.parse(value))

    @staticmethod
    def _size(value: Any) -> tuple[int, int]:
        match = re.fullmatch(r"(\d{1,5})x(\d{1,5})", value) if isinstance(value, str) else None
        if not match or not int(match[1]) or not int(match[2]):
            raise TypeError
        return int(match[1]), int(match[2])

    @staticmethod
    def _whole(least: int, most: int) -> Callable[[Any], int]:
        def parse(value: Any) -> int:
            if type(value) is not int or not least <= value <= most:
                raise TypeError
            return value

        return parse

    @staticmethod
    def _number(least: float, most: float) -> Callable[[Any], float]:
        def parse(value: Any) -> float:
            if isinstance(value, bool) or not isinstance(value, int | float) or not least <= value <= most:
                raise TypeError
            return float(value)

        return parse

    @staticmethod
    def _one_of(values: tuple[int, ...]) -> Callable[[Any], int]:
        def parse(value: Any) -> int:
            if type(value) is not int or value not in values:
                raise TypeError
            return value

        return parse

    def _scene(self, name: str) -> Path:
        """The file of a scene: of the program, or beside the study."""
        found = self._own_scenes.get(name) or self._beside(name)
        if not found.is_file():
            hint = did_you_mean(name, self._own_scenes) or f" ({', '.join(self._own_scenes)})"
            raise self._wrong("scenes", "", f"no file {found}, and no scene of the program{hint}", name)
        return found

    def _beside(self, name: str) -> Path:
        return self._path.parent / Path(name).expanduser()

    # --- where they stand -------------------------------------------------------------------------

    def _table(self, name: str) -> dict[str, Any]:
        table = self._data.get(name, {})
        if not isinstance(table, dict):
            raise self._wrong(name, "", f"it is a table; write [{name}] and its keys below")
        return table

    def _several(self, name: str, parse: Callable[[Any], T], what: str, required: bool = True) -> list[T]:
        value = self._data.get(name)
        if value is None and not required:
            return []
        if value is None:
            raise StudyError(f"{self._path}: no {name}; give a list of {what}")
        if not isinstance(value, list) or not value:
            raise self._wrong(name, "", f"give a list of {what}")
        return self._list(name, "", value, parse, f"give {what}")

    def _list(self, name: str, table: str, values: list[Any], parse: Callable[[Any], T], what: str) -> list[T]:
        found: list[T] = []
        for value in values:
            one = self._parsed(name, table, value, parse, what)
            if one in found:
                raise self._wrong(name, table, f"{_toml(value)} is given twice; once is enough", value)
            found.append(one)
        if not found:
            raise self._wrong(name, table, "the list is empty; give a value, or leave it out")
        return found

    def _one(
        self, name: str, table: str, data: dict[str, Any], parse: Callable[[Any], T], what: str, usual: Any
    ) -> Any:
        if name not in data:
            return usual
        return self._parsed(name, table, data[name], parse, f"give {what}")

    def _parsed(self, name: str, table: str, value: Any, parse: Callable[[Any], T], what: str) -> T:
        try:
            if parse is str and not isinstance(value, str):
                raise TypeError
            return parse(value)
        except TypeError:
            raise self._wrong(name, table, f"{_toml(value)} will not do; {what}", value) from None
        except ValueError as error:
            raise self._wrong(name, table, str(error), value) from None

    def _check_keys(self, data: dict[str, Any], known: tuple[str, ...], table: str) -> None:
        for key in data:
            if key not in known:
                close = similar(key, known)
                hint = f"did you mean {close}?" if close else f"there is {', '.join(known)}"
                raise self._wrong(key, table, f"no such key; {hint}")

    def _wrong(self, name: str, table: str, message: str, value: Any = None) -> StudyError:
        line = self._line(name, table, value)
        where = f", line {line}" if line else ""
        key = ".".join(filter(None, (table, name)))
        return StudyError(f"{self._path}{where}: {key}: {message}" if key else f"{self._path}{where}: {message}")

    def _line(self, name: str, table: str, value: Any) -> int:
        """The line where a value of a key stands, or else the key; 0 where it is not found."""
        inside, at = "", 0
        for number, line in enumerate(self._lines, 1):
            header = re.match(r"\s*\[\[?\s*([^\]\s]+)\s*\]", line)
            if at and (header or re.match(r"\s*[\w\"'-]+\s*=", line)):
                break
            if header:
                inside = header[1].strip("\"'")
                if not table and inside == name:
                    return number
            elif inside == table and re.match(rf"\s*[\"']?{re.escape(name)}[\"']?\s*=", line):
                at = number
            if at and value is not None and _toml(value) in line.replace("'", '"'):
                return number
        return at


def _truth(value: Any) -> bool:
    if not isinstance(value, bool):
        raise TypeError
    return value


def _accelerator(value: Any) -> str:
    if value in ACCELERATORS:
        return str(value)
    hint = did_you_mean(value, ACCELERATORS) if isinstance(value, str) else ""
    if hint:
        raise ValueError(f"{_toml(value)} will not do{hint}")
    raise TypeError


def _listed(values: tuple[int, ...]) -> str:
    return f"{', '.join(map(str, values[:-1]))} and {values[-1]}"


def _toml(value: Any) -> str:
    """A value about as it is written."""
    try:
        return json.dumps(value, ensure_ascii=False)
    except TypeError:
        return str(value)
