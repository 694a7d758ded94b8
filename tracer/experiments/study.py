"""A study: what a sweep traces, read from a TOML file, and cut into tasks that know nothing of one another.

It names scenes by methods by settings by seeds, frame by frame.  A frame of a method that learns nothing is a task of
its own.  A method that learns from frame to frame traces its whole path in one task; or, where the study names a
`warmup`, each of its frames is a task that first traces so many frames before it.  Every task is traced by one thread,
so that even certificates are made in the same order each time.
"""

from __future__ import annotations

import hashlib
import math
import re
import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_type_hints

import msgspec
import numpy as np

from tracer.experiments.experiment import path_times
from tracer.method import Method
from tracer.scene.arrays import vector
from tracer.scene.bounds import bounds
from tracer.scene.files import read_regular, stamp
from tracer.scene.model import Camera, Scene
from tracer.settings import RECORDS, Settings
from tracer.util.setting import kinds_in_words, settings_of
from tracer.util.suggest import did_you_mean, did_you_mean_file

_NOT_VARIED = {"width", "height", "method", "modes", "samples", "threads", "patient", *RECORDS} - {"verify"}
ASPECTS = tuple(one.name for one in settings_of(Settings) if one.name not in _NOT_VARIED)
"""Settings that a study may vary, beside sizes and methods."""
MOST_BYTES = 1 << 20
MOST_SETTINGS = 10_000
MOST_FRAMES = 1_000_000
"""Frames that a study traces by a scene, those before others included: ten million would fill the memory with tasks."""


@dataclass(frozen=True)
class Study:
    """What to trace.

    `scenes` are the names that the study gives, each with its file.  `settings` are all combinations, without a method.
    Each of `seeds` traces all of it once: with `shake`, its cameras are moved aside by a vector of the seed's own, at
    most so many times the scene's diagonal.  `path_frames` resamples the animation; of the path, `first` to `last` are
    traced.  With `warmup`, a method that learns sees only so many frames before each.
    """

    path: Path
    title: str
    scenes: dict[str, Path]
    methods: tuple[str, ...]
    settings: tuple[Settings, ...]
    seeds: tuple[int, ...] = (0,)
    shake: float = 0.0
    path_frames: int | None = None
    first: int = 0
    last: int | None = None
    warmup: int | None = None
    folders: tuple[Path, ...] = ()

    def label(self, name: str) -> str:
        """A scene in a table: the name of its file alone, where no other scene has the same."""
        stem = Path(name).stem
        return stem if sum(Path(other).stem == stem for other in self.scenes) == 1 else name

    def to_json(self) -> dict[str, Any]:
        """The study in full, to be compared with another."""
        aspects = {name: list(dict.fromkeys(getattr(s, name) for s in self.settings)) for name in ASPECTS}
        return {
            "scenes": list(self.scenes),
            "methods": list(self.methods),
            "sizes": list(dict.fromkeys(f"{s.width}x{s.height}" for s in self.settings)),
            **{name: [_plain(value) for value in values] for name, values in aspects.items()},
            "seeds": list(self.seeds),
            "shake": self.shake,
            "frames of the path": self.path_frames,
            "first frame": self.first,
            "last frame": self.last,
            "warmup": self.warmup,
        }

    def tasks(self, name: str, scene: Scene, code: str) -> list[Task]:
        """The tasks of one of its scenes, those that take longest first; `code` is that of the scene's contents.

        Raises ValueError, in one line, where the scene has no such frames."""
        times = path_times(scene, self.path_frames)
        last = len(times) - 1 if self.last is None else self.last
        if not 0 <= self.first <= last < len(times):
            raise ValueError(
                f"{self.path}: path: the frames {self.first} to {last} are not all of {name}, whose path has "
                f"{len(times)}; change first and last"
            )
        numbers = range(self.first, last + 1)
        learning = sum(Method.parse(method).learns for method in self.methods)
        each = len(self.methods) + learning * min(self.warmup or 0, last)
        traced = len(numbers) * each * len(self.settings) * len(self.seeds)
        if traced > MOST_FRAMES:
            raise ValueError(
                f"{self.path}: {traced:,} frames of {name}, by methods, settings and {len(self.seeds):,} seeds; at "
                f"most {MOST_FRAMES:,} are traced: give fewer, or change first and last of the path"
            )
        found: list[Task] = []
        for settings, method, seed in product(self.settings, self.methods, self.seeds):
            wanted = replace(settings, method=method, threads=1)
            task = Task(name, code, wanted, seed, self.shake, len(times), times[0])

            def at(frames: Sequence[int]) -> tuple[tuple[int, float], ...]:
                return tuple((number, times[number]) for number in frames)

            if not Method.parse(method).learns:
                found += [replace(task, frames=at([number])) for number in numbers]
            elif self.warmup is None:
                found.append(replace(task, frames=at(numbers)))
            else:
                for number in numbers:
                    before = at(range(max(0, number - self.warmup), number))
                    found.append(replace(task, frames=at([number]), before=before, warmup=self.warmup))
        return sorted(found, key=lambda task: -task.cost)


@dataclass(frozen=True)
class Task:
    """Some `frames` (number, seconds) of a path of `path_frames`, traced in their order by one method after the frames
    `before`, which are not measured; `start` is the time of the path's first frame.  `warmup` None: from the start."""

    scene: str
    code: str
    settings: Settings
    seed: int
    shake: float
    path_frames: int
    start: float
    frames: tuple[tuple[int, float], ...] = ()
    before: tuple[tuple[int, float], ...] = ()
    warmup: int | None = None

    @cached_property
    def key(self) -> str:
        """A code of all that its results depend on, but the program."""
        words = repr((asdict(self.settings), {k: v for k, v in asdict(self).items() if k != "settings"}))
        return hashlib.blake2b(words.encode(), digest_size=8).hexdigest()

    @property
    def cost(self) -> int:
        """How long it takes, roughly: pixels of all frames."""
        return self.settings.width * self.settings.height * (len(self.frames) + len(self.before))

    @property
    def repeats(self) -> bool:
        """Whether its counters are the same each time: neither chosen by measured times, nor made within a limit of
        time."""
        method = Method.parse(self.settings.method)
        limited = method.has_certificates and math.isfinite(self.settings.certificate_seconds)
        return not method.adaptive and not limited

    def camera(self, scene: Scene, time: float) -> Camera | None:
        """Where its seed puts the camera; None for the scene's own."""
        if not self.shake:
            return None
        box = bounds(scene.objects, scene.animation, self.start)
        lots = np.random.default_rng(self.seed)
        aside = lots.normal(size=3)
        aside *= lots.uniform() / max(float(np.linalg.norm(aside)), 1e-300)
        diagonal = 0.0 if box is None else float(np.linalg.norm(box[1] - box[0]))
        own = scene.camera_at(time)
        return replace(own, position=vector(np.asarray(own.position) + self.shake * diagonal * aside))

    def in_words(self) -> str:
        """Which it is, for messages."""
        numbers = [number for number, _ in self.frames]
        which = f"frame {numbers[0]}" if len(numbers) == 1 else f"frames {numbers[0]} to {numbers[-1]}"
        settings = self.settings
        return f"{self.scene}, {settings.method}, {settings.width}x{settings.height}, {which}"


def _plain(value: Any) -> Any:
    """A value of a setting as JSON has it."""
    return "none" if isinstance(value, float) and not math.isfinite(value) else value


def differences(kept: dict[str, Any], now: dict[str, Any]) -> list[str]:
    """What two studies, as JSON, do not have in common, in words."""
    found = []
    for key, new in now.items():
        old = kept.get(key)
        if old == new:
            continue
        if isinstance(old, list) and isinstance(new, list):
            before, after = (dict.fromkeys(map(str, values)) for values in (old, new))
            more = [f"+ {value}" for value in after if value not in before]
            more += [f"- {value}" for value in before if value not in after]
            found.append(f"{key}: {', '.join(more) or 'in another order'}")
        else:
            found.append(f"{key}: {old} → {new}")
    return found


# --- the file -----------------------------------------------------------------------------------------

T = TypeVar("T")
_Listed = Annotated[tuple[T, ...], msgspec.Meta(min_length=1)]
_Number = Annotated[int, msgspec.Meta(ge=0, le=1_000_000)]


class _Path(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The table `path`."""

    frames: Annotated[int, msgspec.Meta(ge=1, le=1_000_000)] | None = None
    first: _Number = 0
    last: _Number | None = None


if TYPE_CHECKING:
    _Varied = Any
else:
    _TYPES = get_type_hints(Settings)
    _Varied = msgspec.defstruct(
        "_Varied",
        [(name, _TYPES[name] | _Listed[_TYPES[name]], None) for name in ASPECTS],
        frozen=True,
        forbid_unknown_fields=True,
    )
    """The table `settings`: each has one value or several; None stands for the usual one."""


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a study's file may hold."""

    scenes: _Listed[str]
    methods: _Listed[str]
    title: str = ""
    sizes: _Listed[str] = ("512x512",)
    seeds: _Listed[Annotated[int, msgspec.Meta(ge=0, lt=2**31)]] = (0,)
    shake: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    warmup: _Number | None = None
    folders: tuple[str, ...] = ()
    path: _Path = _Path()
    settings: _Varied = _Varied()


_TAKES = {
    "seeds": "a list of whole numbers from 0 to 2147483647",
    "shake": "a number from 0 to 1",
    "frames": "a whole number from 1 to 1000000",
    "first": "a whole number from 0 to 1000000",
    "last": "a whole number from 0 to 1000000",
    "warmup": "a whole number from 0 to 1000000",
}
"""What is said of a value that is none, where the types above give a range."""

_STRING = re.compile(r'"(?:\\.|[^"\\\n])*+"' + r"|'[^'\n]*+'")
_DEEP_KEY = re.compile(r"(?:\.[^.,\n]*+){20}")
"""A key of so many parts as no study has: tomllib takes the square of them in memory."""


class StudyError(ValueError):
    """A study cannot be read; the message is one line."""


def read_study(path: Path, own_scenes: Mapping[str, Path]) -> Study:
    """Read a study; `own_scenes` are those that it may name.

    Raises StudyError and OSError, in one line that names the file, the line in it and the key."""
    try:
        text = read_regular(path, MOST_BYTES).decode("utf-8")
        if _DEEP_KEY.search(_STRING.sub('""', text)):
            raise RecursionError
        data = tomllib.loads(text)
    except FileNotFoundError:
        raise OSError(f"{path}: no such file{did_you_mean_file(path)}") from None
    except OSError as error:
        raise OSError(f"{path}: no study can be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise StudyError(f"{path}: no study: it is not text in UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise StudyError(f"{path}: not TOML: {error}") from None
    except RecursionError:
        raise StudyError(f"{path}: its values are nested too deeply") from None
    return _Reader(path, text).study(data, own_scenes)


class _Reader:
    """Makes a study of the contents of a file, and knows where in it each key stands."""

    def __init__(self, path: Path, text: str) -> None:
        self._path, self._lines = path, text.splitlines()

    def study(self, data: dict[str, Any], own_scenes: Mapping[str, Path]) -> Study:
        try:
            file = msgspec.convert(data, _File)
        except msgspec.ValidationError as error:
            raise self._explained(str(error)) from None
        varied = {name: getattr(file.settings, name) for name in ASPECTS}
        for name, values in (msgspec.structs.asdict(file) | varied).items():
            self._check_once(name, "settings" if name in varied else "", values)
        scenes = {name: self._scene(name, own_scenes) for name in file.scenes}
        try:
            methods = tuple(str(Method.parse(method)) for method in file.methods)
        except ValueError as error:
            raise self._wrong("methods", "", str(error)) from None
        return Study(
            path=self._path,
            title=file.title or self._path.stem,
            scenes=scenes,
            methods=methods,
            settings=self._combinations(file, varied),
            seeds=file.seeds,
            shake=file.shake,
            path_frames=file.path.frames,
            first=file.path.first,
            last=file.path.last,
            warmup=file.warmup,
            folders=tuple(self._beside(folder) for folder in file.folders),
        )

    def _combinations(self, file: _File, varied: dict[str, Any]) -> tuple[Settings, ...]:
        """Every size with every combination of the settings' values."""
        usual = {"verify": False, "accelerator": "kdtree"}  # as in `bench`
        values = {name: value if value is not None else usual.get(name) for name, value in varied.items()}
        lists = [value if isinstance(value, tuple) else (value,) for value in values.values()]
        if math.prod(len(some) for some in [file.sizes, *lists]) > MOST_SETTINGS:
            raise self._wrong("settings", "", f"more than {MOST_SETTINGS:,} combinations; leave some out")
        found = []
        for size, *chosen in product(file.sizes, *lists):
            sides = re.fullmatch(r"(\d{1,5})x(\d{1,5})", size)
            if sides is None:
                raise self._wrong("sizes", "", f'{size!r} is no size; give one such as "640x480"')
            given = {name: value for name, value in zip(ASPECTS, chosen) if value is not None}
            try:
                found.append(Settings(int(sides[1]), int(sides[2]), method="none", **given).validated())
            except ValueError as error:
                name = next((name for name in ASPECTS if name in str(error)), "sizes")
                raise self._wrong(name, "settings" if name in given else "", str(error)) from None
        return tuple(found)

    def _scene(self, name: str, own_scenes: Mapping[str, Path]) -> Path:
        """The file of a scene: of the program, or beside the study."""
        found = own_scenes.get(name) or self._beside(name)
        if stamp(found) is None or not found.is_file():
            hint = did_you_mean(name, own_scenes) or f" ({', '.join(own_scenes)})"
            raise self._wrong("scenes", "", f"no file {found}, and no scene of the program{hint}")
        return found

    def _beside(self, name: str) -> Path:
        return self._path.parent / Path(name).expanduser()

    # --- what is wrong, and where -----------------------------------------------------------------

    def _check_once(self, name: str, table: str, values: Any) -> None:
        times = Counter(values if isinstance(values, tuple) else ())
        twice = [value for value, number in times.items() if number > 1]
        if twice:
            raise self._wrong(name, table, f"{twice[0]!r} is given twice; once is enough")

    def _explained(self, message: str) -> StudyError:
        """What msgspec says of a value, such as "Expected `int`, got `str` - at `$.path.frames`", in plain words."""
        what, _, place = message.partition(" - at `$")
        keys = re.findall(r"\w+", re.sub(r"\[.*?\]", "", place))
        unknown, missing = re.search(r"unknown field `(.*)`", what), re.search(r"missing required field `(.*)`", what)
        if unknown is not None:
            kind: type[msgspec.Struct] = {"path": _Path, "settings": _Varied}.get(keys[0] if keys else "", _File)
            known = kind.__struct_fields__
            hint = did_you_mean(unknown[1], known) or f"; there is {', '.join(known)}"
            return self._wrong(unknown[1], keys[0] if keys else "", f"no such key{hint}")
        if missing is not None:
            return StudyError(f"{self._path}: no {missing[1]}; give a list")
        *table, name = keys
        expected = (one.expected for one in settings_of(Settings) if one.name == name and one.kind is not bool)
        takes = next((f"{values}, or a list of such" for values in expected), "")
        takes = takes or _TAKES.get(name, "")
        plain = re.sub(r"`(.*?)`", kinds_in_words, what[:1].lower() + what[1:])
        return self._wrong(name, ".".join(table), f"{plain}; give {takes}" if takes else plain)

    def _wrong(self, name: str, table: str, message: str) -> StudyError:
        line = self._line(name, table)
        return StudyError(f"{self._path}{f', line {line}' * (line > 0)}: {f'{table}.' * bool(table)}{name}: {message}")

    def _line(self, name: str, table: str) -> int:
        """The line where a key stands, 0 where it is not found."""
        inside = ""
        for number, line in enumerate(self._lines, 1):
            header = re.match(r"\s*\[\s*([^\]\s]+)\s*\]", line)
            if header:
                inside = header[1]
            is_key = inside == table and re.match(rf"\s*[\"']?{re.escape(name)}[\"']?\s*=", line)
            if is_key or (header and not table and inside == name):
                return number
        return 0
