"""All that a picture depends on, as one frozen value: what undo, bookmarks, captures, presets and commands hold; and
what is otherwise in one state than in another, in a few words."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

from tracer.editing.edits import NO_EDITS, Edits
from tracer.experiments.warmup_frames import MOST_WARMUP_FRAMES, WarmupFrame
from tracer.geometry.accelerators import ACCELERATORS
from tracer.method import Method
from tracer.scene.camera import Camera
from tracer.scene.limits import LARGEST
from tracer.scene.mesh_options import AS_IN_FILE, MeshOptions
from tracer.settings import Settings
from tracer.util.setting import ALWAYS, AS_DEFAULT, Setting, check_all, setting, settings_of
from viewer.state.comparison import Compare
from viewer.state.draw_options import DrawOptions

LONGEST_FIXED_SIDE = 8192
"""Pixels of a picture of fixed size."""


def _fixed_size(state: ViewState) -> bool:
    return state.pace.fixed_size


@dataclass(frozen=True)
class Pace:
    """How the window traces: in what size, how fast in motion, and what it does while nothing moves."""

    fixed_size: bool = setting(
        False, "Fixed size", "Trace pictures of a resolution of their own, not of the window's.", panel="Rendering"
    )
    width: int = setting(Settings.width, "Picture width", "Of pictures of fixed size.", low=1, high=LONGEST_FIXED_SIDE,
                         applies=_fixed_size, unit=" px")  # fmt: skip
    height: int = setting(Settings.height, "Picture height", "Of pictures of fixed size.", low=1,
                          high=LONGEST_FIXED_SIDE, applies=_fixed_size, unit=" px")  # fmt: skip
    progressive: bool = setting(
        True, "Progressive refinement",
        "Show pictures before all of their pixels are shaded, so that frames come fast.", panel="Rendering",
    )  # fmt: skip
    target_fps: float = setting(
        15.0, "In motion", "Frames per second to aim at.", low=1.0, high=240.0, slider=(2.0, 60.0), unit=" fps",
        digits=0, panel="Rendering", applies=lambda state: state.pace.progressive,
    )  # fmt: skip
    keep_tracing: bool = setting(
        False, "Keep tracing when idle",
        "Trace frame after frame, to watch how modes are set and certificates made.", panel="Culling",
    )  # fmt: skip
    every_frame: bool = setting(
        False,
        "Trace every frame",
        "Play every frame of the animation, each traced in full, however long it takes; otherwise play in real time.",
    )
    certificate_share: float = setting(
        0.15, "Certificate budget",
        "The share of each frame's time for certificates while anything moves; when idle they get more.",
        low=0.0, high=0.9, percent=True, digits=0, panel="Culling",
        applies=lambda state: Method.parse(state.settings.method).has_certificates,
    )  # fmt: skip


@dataclass(frozen=True)
class Warmup:
    """The frames from which a picture's modes, certificates and caches were learnt, in the order they were traced.

    First those in `frames`, then `of_path` frames of the scene's path that lead up to it, then the picture's own frame
    `repeats` times.  `modes` stand for all of them where they are known themselves (`viewer.output.commands`);
    `unknown` says, in words, why no frames bring them back."""

    frames: tuple[WarmupFrame, ...] = ()
    of_path: int = 0
    repeats: int = 0
    modes: str = ""
    unknown: str = ""


@dataclass(frozen=True)
class ViewState:
    """All that a picture depends on.

    `scene` is the path of its file, `meshes` says how it is read, `edits` what is otherwise in it; `camera` None is the
    scene's own, which goes along its path.  `compare` is the window's alone, and never stored."""

    scene: str = ""
    meshes: MeshOptions = AS_IN_FILE
    edits: Edits = NO_EDITS
    time: float = 0.0
    camera: Camera | None = None
    settings: Settings = field(default_factory=Settings)
    draw: DrawOptions = field(default_factory=DrawOptions)
    pace: Pace = field(default_factory=Pace)
    warmup: Warmup = field(default_factory=Warmup)
    compare: Compare = field(default_factory=Compare)

    @staticmethod
    def in_window() -> ViewState:
        """Return what the window starts with."""
        state = ViewState()
        for one in settings_of(ViewState):
            state = one.put(state, one.in_window) if one.in_window != AS_DEFAULT else state
        return state

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture in pixels."""
        return self.settings.width, self.settings.height

    def applies(self, one: Setting) -> bool:
        """Return whether one of its settings does anything as it is."""
        return one.applies(self.settings if one.within == ("settings",) else self)

    def with_draw(self, **options: Any) -> ViewState:
        """Return it with other options of drawing."""
        return replace(self, draw=replace(self.draw, **options))

    def with_warmup(self, **warmup: Any) -> ViewState:
        """Return it with other frames before it."""
        return replace(self, warmup=replace(self.warmup, **warmup))

    def with_settings(self, **settings: Any) -> ViewState:
        """Return it with other settings of tracing."""
        return replace(self, settings=replace(self.settings, **settings))

    @property
    def depends_on_modes(self) -> bool:
        """Whether its picture depends on what was seen before it."""
        return not Method.parse(self.settings.method).exact or self.draw.view.of_modes

    def on_machine_of(self, other: ViewState) -> ViewState:
        """Return it with the settings of another that belong to its machine: threads, tree, size."""
        state = self
        for one in settings_of(ViewState):
            state = state if one.stored == ALWAYS else one.put(state, one.get(other))
        return state

    def validated(self) -> ViewState:
        """Return it, checked; raises ValueError, in one line, where a value is out of range."""
        check_all(self)
        if not math.isfinite(self.time):
            raise ValueError("the time is not a finite number")
        for camera in (self.camera, *(frame.camera for frame in self.warmup.frames)):
            if camera is not None:
                Camera.from_json(camera.to_json())
        places = [part for _, place in self.edits.moved_lights for part in place]
        times = [time for _, time in self.edits.static] + [frame.time for frame in self.warmup.frames]
        numbers = [*self.edits.lights_off, *self.edits.hidden_primitives, *(n for n, _ in self.edits.moved_lights)]
        if (
            not all(abs(part) <= LARGEST for part in places)
            or not all(map(math.isfinite, times))
            or min([0, *numbers]) < 0
        ):
            raise ValueError("the edits of the scene are out of range")
        if not 0 <= max(self.warmup.of_path, self.warmup.repeats, len(self.warmup.frames)) <= MOST_WARMUP_FRAMES:
            raise ValueError(f"a picture has 0 to {MOST_WARMUP_FRAMES:,} frames before it")
        if self.settings.accelerator not in ACCELERATORS:
            raise ValueError(f"the tree {self.settings.accelerator} is not known")
        return self


# --- what is otherwise -------------------------------------------------------------------------------

CAMERA = "camera"


class EditKind(NamedTuple):
    """A kind of edit: what is edited, what it is then and what without the edit, and the option that asks for it."""

    called: str
    edited: str
    unedited: str
    option: str
    metavar: str
    help: str


EDITS = {
    "lights_off": EditKind("light {}", "off", "on", "--without-light", "N", "switch off this light"),
    "moved_lights": EditKind("light {}", "moved", "where it was", "--move-light", "N=X,Y,Z",
                             "put this light elsewhere"),
    "hidden": EditKind("{}", "hidden", "shown", "--hide", "NAME", "hide this object"),
    "hidden_primitives": EditKind("primitive {}", "hidden", "shown", "--hide-primitive", "N",
                                  "hide this primitive alone"),
    "static": EditKind("{}", "static", "moving", "--make-static", "NAME=T",
                       "freeze a moving object where it is at T seconds, as static geometry"),
    "moving": EditKind("{}", "moving", "static", "--make-moving", "NAME",
                       "treat a static object as one that could move; it stays where it is"),
}  # fmt: skip
"""By the fields of `Edits`."""


def changes(old: ViewState, new: ViewState) -> dict[str, str]:
    """Return what has changed from one state to another: for each field, in a few words, what it is now."""
    changed = {
        one.path: one.in_words(one.get(new))
        for one in settings_of(ViewState)
        if one.stored == ALWAYS and one.get(old) != one.get(new)
    }
    changed |= {f"comparison.{name}": said for name, said in old.compare.changes(new.compare).items()}
    if old.camera != new.camera:
        changed[CAMERA] = "camera onto the scene's path" if new.camera is None else "camera"
    return changed | edits_in_words(old.edits, new.edits)


def edits_in_words(before: Edits, after: Edits) -> dict[str, str]:
    """Return what has changed from the one to the other: for each target, in a few words, what it is now."""
    changed = {}
    for name, kind in EDITS.items():
        old, new = _targets(before, name), _targets(after, name)
        for target in sorted(target for target in {**old, **new} if old.get(target) != new.get(target)):
            now = kind.edited if target in new else kind.unedited
            changed[f"{name} {target}"] = f"{kind.called.format(target)} {now}"
    return changed


def one_by_one(edits: Edits) -> list[tuple[str, Edits]]:
    """Return each edit in a few words, and all others without it."""
    found = []
    for item in fields(Edits):
        kept = getattr(edits, item.name)
        for one in kept:
            without = replace(edits, **{item.name: type(kept)(other for other in kept if other != one)})
            found += [(said, without) for said in edits_in_words(without, edits).values()]
    return sorted(found, key=lambda pair: pair[0])


def as_options(edits: Edits) -> list[str]:
    """Return the options of a command line that ask for these edits, to the bit."""
    options = []
    for name, kind in EDITS.items():
        for target, value in sorted(_targets(edits, name).items()):
            place = ",".join(map(repr, value)) if isinstance(value, tuple) else repr(value)
            options.append(f"{kind.option}={target}" + ("" if value is True else f"={place}"))
    return options


def _targets(edits: Edits, name: str) -> dict[Any, Any]:
    """Return what a field of edits is about, each with its place, its time or True."""
    kept = getattr(edits, name)
    return dict(kept) if isinstance(kept, tuple) else dict.fromkeys(kept, True)
