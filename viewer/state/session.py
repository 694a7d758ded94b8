"""What the user is looking at: scene, camera, time, settings, view; saved and restored as one value.

The camera either follows the scene's own path or is free.  It follows until the user moves it;
time goes on in both cases, so that one can stand still and watch things move.  A `Snapshot` is
all of that as plain JSON: it is what a bookmark keeps and what a captured picture carries.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from tracer.renderer import Settings
from tracer.scene.edits import NO_EDITS, Edited, Edits, edited
from tracer.scene.lights import number_of
from tracer.scene.mesh_options import AS_IN_FILE, MeshOptions
from tracer.scene.model import Camera, Scene
from tracer.setting import check_all
from tracer.settings import RECORDS
from viewer.state import codec
from viewer.state import edits as scene_edits
from viewer.state.comparison import Comparison
from viewer.state.draw_options import MIDDLE, Slice
from viewer.state.tone import NEUTRAL, Tone
from viewer.state.views import View
from viewer.state.zooming import FIT, Zoom
from viewer.util.json_numbers import finite, number, whole

# Settings that say how a frame was asked for, not what the user chose; those of this machine and of the open scene.
_NOT_RESTORED = {
    "width", "height", "threads", "accelerator", "modes", "certificates", "certificate_seconds", "patient",
    *(name for name in RECORDS if name != "verify"),
}  # fmt: skip
_OPTIONAL: dict[str, type] = {"lamp_radius": float, "lamp_samples": int}  # None: as the scene says


@dataclass(frozen=True)
class Snapshot:
    """A state to come back to.  `settings` holds the fields of `tracer.Settings`; `scene` is a path, and
    `meshes` says how it was read."""

    scene: str
    time: float
    camera: Camera
    follow: bool
    settings: dict[str, Any]
    view: View
    light: int
    wipe: float = 0.5
    tone: Tone = NEUTRAL
    span: tuple[float, float] | None = None
    meshes: MeshOptions = AS_IN_FILE
    edits: Edits = NO_EDITS
    cut: Slice = MIDDLE

    def to_json(self) -> dict[str, Any]:
        data = {name: value for name, value in asdict(self).items() if name != "edits"}
        if self.edits:
            data["edits"] = scene_edits.to_json(self.edits)
        data |= {"slice": list(data.pop("cut"))}
        return data | {"camera": self.camera.to_json(), "view": self.view.value, "tone": codec.to_json(self.tone)}

    @staticmethod
    def from_json(data: Any) -> Snapshot:
        """The inverse of `to_json`; raises ValueError, in one line, on anything else."""
        if not isinstance(data, Mapping):
            raise ValueError("no saved state in it")
        try:
            time, wipe = finite(data["time"]), number(data.get("wipe", 0.5))
            return Snapshot(
                scene=str(data["scene"]),
                time=time,
                camera=Camera.from_json(data["camera"]),
                follow=bool(data.get("follow", False)),
                settings=settings_from_json(data.get("settings", {})),
                view=View(data.get("view", View.COLOR)),
                light=max(0, whole(data.get("light", 0))),
                wipe=wipe if 0.0 <= wipe <= 1.0 else 0.5,
                tone=check_all(codec.patched(NEUTRAL, data.get("tone", {}))),
                span=_span(data.get("span")),
                meshes=_meshes_from_json(data.get("meshes", {})),
                edits=scene_edits.from_json(data.get("edits", {})),
                cut=_slice(data.get("slice", list(MIDDLE))),
            )
        except KeyError as error:
            raise ValueError(f"its saved state lacks {error}") from None
        except TypeError:
            raise ValueError("its saved state is damaged") from None


def _slice(data: Any) -> Slice:
    """A slice through space, if it is one."""
    try:
        found = Slice(int(data[0]), number(data[1]))
        found.check()
    except (TypeError, ValueError, IndexError):
        raise ValueError("its slice is damaged") from None
    return found


def _span(data: Any) -> tuple[float, float] | None:
    """A range of the colour map, if it is one."""
    if data is None:
        return None
    try:
        low, high = (finite(end) for end in data)
    except (TypeError, ValueError):
        raise ValueError("its range is damaged") from None
    if not low < high:
        raise ValueError("its range is none")
    return low, high


def settings_to_json(settings: Settings) -> dict[str, Any]:
    """What is kept of settings, in a snapshot."""
    return {name: value for name, value in asdict(settings).items() if name not in _NOT_RESTORED}


def settings_from_json(data: Any) -> dict[str, Any]:
    """The known fields of stored settings, checked by `Settings.validated`; raises ValueError."""
    if not isinstance(data, Mapping):
        raise ValueError("its settings are damaged")
    names = {f.name for f in fields(Settings)} - _NOT_RESTORED
    known = {name: value for name, value in data.items() if name in names}
    for name, value in known.items():
        kinds = (type(None), _OPTIONAL[name]) if name in _OPTIONAL else (type(getattr(Settings(), name)),)
        if type(value) not in kinds and not (type(value) is int and float in kinds):
            raise ValueError(f"its setting {name} is not understood")
        if float in kinds and value is not None:
            known[name] = number(value)
    replace(Settings(), **known).validated()
    return known


def _meshes_from_json(data: Any) -> MeshOptions:
    """How a mesh was read; raises ValueError."""
    up, crease = (data.get(key) for key in ("up", "crease")) if isinstance(data, Mapping) else (0, 0)
    if not (up is None or isinstance(up, str)) or not (crease is None or type(crease) in (int, float)):
        raise ValueError("its options of meshes are not understood")
    return MeshOptions(bool(data.get("studio", False)), up, None if crease is None else number(crease))


@dataclass
class Session:
    """The state behind the window; plain data and what it implies, no threads and no widgets.

    `spans` are the ranges that were chosen for views of numbers; `clipping` marks what the screen cuts off; `zoom` is
    how closely the picture itself is looked at, `comparison` what is compared with it.  `edits` are what is to be
    otherwise than in the scene as it was read, `edited` is what is of that: `scene` is the scene with it, of whose
    lights `light` is one, and `light_to_come` of those that are to be.  `previewed` is what the GPU draws before there
    is a `scene`."""

    scene: Scene | None = None
    previewed: Scene | None = None
    edits: Edits = NO_EDITS
    edited: Edited | None = None
    light_to_come: int | None = None
    time: float = 0.0
    free_camera: Camera | None = None
    playing: bool = False
    settings: Settings = field(default_factory=Settings)
    view: View = View.COLOR
    light: int = 0
    counting: bool = False  # whether frames are to count the rays at each pixel, whatever the view
    wipe: float = 0.5
    tone: Tone = NEUTRAL
    clipping: bool = False
    spans: dict[View, tuple[float, float]] = field(default_factory=dict)
    cut: Slice = MIDDLE  # that is shown of space
    zoom: Zoom = FIT
    comparison: Comparison = field(default_factory=Comparison)
    selected: tuple[float, float] | None = None
    meshes: MeshOptions = AS_IN_FILE  # how the scene was read
    _on_path: tuple[Scene, float, Camera] | None = field(default=None, init=False, repr=False, compare=False)

    @property
    def seen(self) -> Scene | None:
        """The scene that the camera moves in."""
        return self.scene or self.previewed

    @property
    def follow(self) -> bool:
        """Whether the camera goes along the scene's own path."""
        return self.free_camera is None

    @property
    def camera(self) -> Camera:
        if self.free_camera is not None:
            return self.free_camera
        scene = self.seen
        if scene is None:
            return Camera((0, 0, 5), (0, 0, -1))
        kept = self._on_path
        if kept is None or kept[0] is not scene or kept[1] != self.time:  # it is asked for many times a frame
            kept = self._on_path = scene, self.time, scene.camera_at(self.time)
        return kept[2]

    def move(self, camera: Camera) -> None:
        """Take the camera in hand."""
        self.free_camera = camera

    def open(self, scene: Scene) -> None:
        """Look at another scene from its own first camera; settings and view stay, but for the radius of lamps, which
        is measured in units of the scene that was open."""
        if self.scene is not None and scene.path != self.scene.path:
            self.settings = replace(self.settings, lamp_radius=None)
            self.zoom = FIT
        self.scene = scene
        self.edits, self.edited, self.light_to_come = NO_EDITS, edited(scene, NO_EDITS), None
        self.time = scene.time_range[0]
        self.free_camera = None
        self.playing = False
        self.selected = None
        self.light = min(self.light, max(len(scene.lights) - 1, 0))

    @property
    def original(self) -> Scene | None:
        """The scene as it was read."""
        return self.edited.original if self.edited is not None else self.scene

    def take(self, now: Edited) -> None:
        """Look at the same scene, edited otherwise; the chosen light stays, or becomes the one after it."""
        before = self.edited
        if self.light_to_come is not None and now.edits == self.edits:
            self.light, self.light_to_come = self.light_to_come, None
        elif before is not None and self.light < len(before.lights):
            number = int(before.lights[self.light])
            self.light = int((now.lights < number).sum())
        self.scene, self.edited = now.scene, now
        self.light = min(self.light, max(len(now.lights) - 1, 0))

    def want(self, edits: Edits, light: int) -> None:
        """Want other edits, and this light of those that are on then."""
        if self.original is not None and self.edited is not None:
            self.edits = edits.within(self.original)
            self.light_to_come = light if self.edits != self.edited.edits else None

    @property
    def animated(self) -> bool:
        return self.scene is not None and self.scene.frames > 1 and self.scene.time_range[1] > self.scene.time_range[0]

    @property
    def frame(self) -> int:
        """The number of the frame whose time is nearest."""
        return self.frame_at(self.time)

    @property
    def light_number(self) -> int:
        """The number of the chosen light in the scene as it was read."""
        return number_of(self.scene.lights, self.light) if self.scene is not None else self.light

    def frame_at(self, time: float) -> int:
        """The number of the frame whose time is nearest to some time in seconds."""
        if self.scene is None or not self.animated:
            return 0
        start, end = self.scene.time_range
        return round((time - start) / (end - start) * (self.scene.frames - 1))

    def go_to_frame(self, frame: int) -> None:
        if self.scene is not None:
            self.time = self.scene.frame_time(min(max(frame, 0), self.scene.frames - 1))

    def advance(self, seconds: float, loop: bool) -> None:
        """Let time pass; at the end start again or stop."""
        if self.scene is None or not self.animated:
            self.playing = False
            return
        start, end = self.scene.time_range
        self.time += seconds
        if self.time > end:
            self.time = start + (self.time - start) % (end - start) if loop else end
            self.playing = loop

    def advance_frame(self, loop: bool) -> None:
        """Go on by one frame of the path; at the end start again or stop."""
        if self.scene is None or not self.animated:
            self.playing = False
        elif self.frame + 1 < self.scene.frames:
            self.go_to_frame(self.frame + 1)
        elif loop:
            self.go_to_frame(0)
        else:
            self.playing = False

    def snapshot(self) -> Snapshot:
        """Where we are now; raises ValueError without a scene."""
        if self.scene is None:
            raise ValueError("there is no scene yet")
        return Snapshot(
            scene=str(Path(self.scene.path).absolute()),
            time=self.time,
            camera=self.camera,
            follow=self.follow,
            settings=settings_to_json(self.settings),
            view=self.view,
            light=self.light,
            wipe=self.wipe,
            tone=self.tone,
            span=self.spans.get(self.view),
            meshes=self.meshes,
            edits=self.edits,
            cut=self.cut,
        )

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of the scene that is open (its path is the caller's business)."""
        if self.scene is None:
            return
        start, end = self.scene.time_range
        self.time = min(max(snapshot.time, start), end)
        self.free_camera = None if snapshot.follow else snapshot.camera
        self.playing = False
        self.settings = replace(self.settings, **{k: v for k, v in snapshot.settings.items() if k not in _NOT_RESTORED})
        self.view = snapshot.view
        self.light = min(snapshot.light, max(len(self.scene.lights) - 1, 0))
        self.wipe, self.tone, self.cut = snapshot.wipe, snapshot.tone, snapshot.cut
        self.spans.pop(snapshot.view, None)
        if snapshot.span is not None:
            self.spans[snapshot.view] = snapshot.span
        self.want(snapshot.edits, snapshot.light)
