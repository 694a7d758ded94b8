"""A camera as text that other programs read: JSON as `shadowcull render --camera` takes it, pbrt's statements, and the
arguments of Embree's viewer; and back again.

pbrt's world is left-handed and ours is right-handed, so that its files for such scenes begin with `Scale -1 1 1`,
which mirrors the picture.  pbrt's angle is that of the shorter side of the picture, Embree's and ours is that of its
height."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass, replace

import numpy as np

from tracer.scene.model import Camera

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_PBRT_ANGLE = 90.0  # degrees, where a pbrt camera says nothing
_EMBREE_NAMES = {"vp": "position", "vi": "target", "vd": "direction", "vu": "up", "fov": "angle"}
_EMBREE = {f"{dashes}{short}": name for short, name in _EMBREE_NAMES.items() for dashes in ("-", "--")}
_PBRT_SIZE = ("xresolution", "yresolution")


@dataclass(frozen=True)
class Pasted:
    """A camera that was read, what kind of text it was, and what of that text could not be used."""

    camera: Camera
    kind: str
    unused: tuple[str, ...] = ()


def as_json(camera: Camera) -> str:
    return json.dumps(camera.to_json())


def as_pbrt(camera: Camera, aspect: float) -> str:
    """Statements for a picture whose width is `aspect` times its height."""
    eye, target, up = _points(camera)
    angle = camera.angle if aspect >= 1.0 else _across(camera.angle, aspect)
    return (
        "Scale -1 1 1  # the world is right-handed\n"
        f"LookAt {_row(eye)}\n       {_row(target)}\n       {_row(up)}\n"
        f'Camera "perspective" "float fov" [ {_short(angle)} ]\n'
    )


def as_embree(camera: Camera) -> str:
    """Arguments of Embree's viewer, in one line."""
    eye, target, up = _points(camera)
    return f"--vp {_row(eye)} --vi {_row(target)} --vu {_row(up)} --fov {_short(camera.angle)}"


def read(text: str, now: Camera, aspect: float) -> Pasted:
    """The camera of a text of any of the three kinds; what it leaves open stays as `now`, seen in a picture whose width
    is `aspect` times its height.  Raises ValueError, in one line, on anything else."""
    text = text.strip()
    if not text:
        raise ValueError("the clipboard holds no text")
    if text[0] in "{[":
        return _read_json(text, now)
    if re.search(r"(^|\s)--?(v[pidu]|fov)\s", text):
        return _read_embree(text, now)
    if re.search(r"^\s*(LookAt|Camera|Transform|ConcatTransform|Scale|Rotate|Translate)\b", text, re.MULTILINE):
        return _read_pbrt(text, now, aspect)
    raise ValueError("the clipboard holds no camera: neither JSON, nor pbrt's LookAt, nor Embree's --vp --vi --vu")


# --- the three kinds ---------------------------------------------------------------------------------


def _read_json(text: str, now: Camera) -> Pasted:
    try:
        data = json.loads(text)
    except ValueError as error:
        raise ValueError(f"the clipboard holds broken JSON: {error}") from None
    if isinstance(data, dict) and isinstance(data.get("camera"), dict):
        data = data["camera"]  # of a snapshot, as saved pictures and bookmarks hold
    if not isinstance(data, dict) or "position" not in data:
        raise ValueError("the clipboard holds JSON without a camera: it has position, direction, up and angle")
    known = {"position", "direction", "up", "angle"}
    camera = Camera.from_json(now.to_json() | {name: data[name] for name in known & data.keys()})
    return Pasted(camera, "JSON", tuple(sorted(data.keys() - known)))


def _read_embree(text: str, now: Camera) -> Pasted:
    words = text.replace("\\\n", " ").split()
    found: dict[str, tuple[float, ...]] = {}
    unused: list[str] = []
    i = 0
    while i < len(words):
        name = _EMBREE.get(words[i])
        if name is None:
            if words[i].startswith("-") and not re.fullmatch(_NUMBER, words[i]):
                unused.append(words[i])
            i += 1
            continue
        count = 1 if name == "angle" else 3
        found[name] = _numbers(words[i], words[i + 1 : i + 1 + count], count)
        i += 1 + count
    return Pasted(_camera(found, now), "Embree's arguments", tuple(unused))


def _read_pbrt(text: str, now: Camera, aspect: float) -> Pasted:
    text = re.sub(r"#[^\n]*", "", text)
    found: dict[str, tuple[float, ...]] = {}
    unused: list[str] = []
    looks = list(re.finditer(rf"\bLookAt((?:[\s\[\]]+{_NUMBER}){{9}})", text))
    if looks:
        values = [float(x) for x in re.findall(_NUMBER, looks[-1][1])]
        found["position"], found["target"], found["up"] = (tuple(values[k : k + 3]) for k in (0, 3, 6))
    elif re.search(r"\bLookAt\b", text):
        raise ValueError("pbrt's LookAt needs nine numbers: where the camera is, what it looks at, and its up")
    before = text[: looks[-1].start()] if looks else text
    mirrored = bool(re.search(r"\bScale\s+\[?\s*-1(\.0*)?\s+1(\.0*)?\s+1(\.0*)?\b", before))
    size = {name: _parameter(text, name) for name in _PBRT_SIZE}
    if all(size.values()):
        aspect = size["xresolution"] / size["yresolution"]  # type: ignore[operator]
    camera = re.search(r'\bCamera\s+"(\w+)"((?:\s+"[^"]*"\s*(?:\[[^\]]*\]|"[^"]*"|[-+.\deE]+))*)', text)
    if camera is not None:
        unused += _pbrt_camera(camera, found, aspect)
    rest = re.sub(r"\bScale\s+\[?\s*-1(\.0*)?\s+1(\.0*)?\s+1(\.0*)?", "", text)
    unused += sorted(set(re.findall(r"^\s*(Transform|ConcatTransform|Scale|Rotate|Translate)\b", rest, re.MULTILINE)))
    if not found:
        raise ValueError("pbrt's statements hold neither LookAt nor a perspective camera")
    if looks and not mirrored:
        unused.append("the mirrored picture that pbrt makes without Scale -1 1 1")
    return Pasted(_camera(found, now), "pbrt's statements", tuple(unused))


def _pbrt_camera(camera: re.Match[str], found: dict[str, tuple[float, ...]], aspect: float) -> list[str]:
    """Take the angle of a `Camera` statement; returns what else it says."""
    if camera[1] != "perspective":
        return [f'Camera "{camera[1]}"']
    angle = _parameter(camera[2], "fov")
    half = _parameter(camera[2], "halffov")
    angle = 2.0 * half if angle is None and half is not None else _PBRT_ANGLE if angle is None else angle
    if not 0.0 < angle < 180.0:
        raise ValueError("the angle of pbrt's camera lies between 0 and 180 degrees")
    found["angle"] = (angle if aspect >= 1.0 else _across(angle, 1.0 / aspect),)
    names = re.findall(r'"\w+\s+(\w+)"', camera[2])
    return [name for name in names if name not in ("fov", "halffov")]


# --- numbers -----------------------------------------------------------------------------------------


def _camera(found: dict[str, tuple[float, ...]], now: Camera) -> Camera:
    data = now.to_json()
    position = found.get("position", now.position)
    data["position"] = list(position)
    if "target" in found:
        way = np.subtract(found["target"], position)
        length = float(np.linalg.norm(way))
        if not length or not math.isfinite(length):
            raise ValueError("the camera stands where it looks at")
        data["direction"] = (way / length).tolist()
    elif "direction" in found:
        data["direction"] = list(found["direction"])
    if "up" in found:
        if not any(found["up"]):
            raise ValueError("the camera's up is zero")
        data["up"] = list(found["up"])
    if "angle" in found:
        data["angle"] = found["angle"][0]
    return replace(Camera.from_json(data))


def _points(camera: Camera) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where it is, a point one unit ahead, and its up."""
    _, up, view = camera.basis()
    eye = np.asarray(camera.position, np.float64)
    return eye, eye + view, up


def _across(angle: float, aspect: float) -> float:
    """The angle of the width where `angle` is that of the height, in degrees; and back with 1 / aspect."""
    return math.degrees(2.0 * math.atan(math.tan(math.radians(angle) / 2.0) * aspect))


def _numbers(name: str, words: list[str], count: int) -> tuple[float, ...]:
    if len(words) < count or not all(re.fullmatch(_NUMBER, word) for word in words):
        raise ValueError(f"{name} needs {'a number' if count == 1 else 'three numbers'} after it")
    return tuple(float(word) for word in words)


def _parameter(text: str, name: str) -> float | None:
    found = re.search(rf'"(?:float|integer)\s+{name}"\s*\[?\s*({_NUMBER})', text)
    return float(found[1]) if found is not None else None


def _row(vector: np.ndarray) -> str:
    return " ".join(_short(x) for x in vector)


def _short(number: float) -> str:
    """Twelve digits, so that the camera comes back as it was far from the origin too; no minus before a zero."""
    return f"{float(number) + 0.0:.12g}"
