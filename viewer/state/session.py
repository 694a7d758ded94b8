"""What the window looks at: one state, and what is live beside it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from tracer.editing.edits import NO_EDITS, Edited, Edits, edited
from tracer.frame import Frame
from tracer.scene.lights import number_of
from tracer.scene.model import Camera, Scene
from tracer.settings import Settings
from viewer.state.draw_options import DrawOptions
from viewer.state.pixels import FIT
from viewer.state.view_state import Pace, ViewState

NOWHERE = Camera((0, 0, 5), (0, 0, -1))
"""Where the picture is taken from while no scene is open."""


@dataclass
class Session:
    """The state that is shown, or will be as soon as it is traced, and what belongs to no state.

    `scene` is the scene as it is edited: `state.edits` are what is wanted of edits, `edited` what there is of them, and
    `light_to_come` is the light that is chosen once they are there.  `counting` asks for frames that count
    the rays at each pixel, whatever the view."""

    scene: Scene | None = None
    state: ViewState = field(default_factory=ViewState)
    edited: Edited | None = None
    light_to_come: int | None = None
    playing: bool = False
    counting: bool = False
    _on_path: tuple[Scene, float, Camera] | None = field(default=None, init=False, repr=False, compare=False)
    _fixed: tuple[Pace, Pace] | None = field(default=None, init=False, compare=False)  # of `fix_size`, and before it

    # --- the state -------------------------------------------------------------------------------

    @property
    def settings(self) -> Settings:
        return self.state.settings

    @property
    def draw(self) -> DrawOptions:
        return self.state.draw

    @property
    def time(self) -> float:
        return self.state.time

    @property
    def edits(self) -> Edits:
        return self.state.edits

    def change(self, **fields: Any) -> None:
        """Change fields of the state."""
        self.state = replace(self.state, **fields)

    def set_draw(self, **options: Any) -> None:
        """Change how frames are drawn."""
        self.state = self.state.with_draw(**options)

    def set_settings(self, **settings: Any) -> None:
        """Change what is traced; nothing is checked."""
        self.state = self.state.with_settings(**settings)

    def set_pace(self, **pace: Any) -> None:
        """Change how the window traces."""
        self.change(pace=replace(self.state.pace, **pace))

    def fix_size(self, width: int, height: int, **pace: Any) -> None:
        """Trace in a size that the user has not chosen, until `give_size_back`, or until another scene is opened."""
        before = self.state.pace
        if self._fixed is not None and self._fixed[0] == before:
            before = self._fixed[1]
        self.set_pace(fixed_size=True, width=width, height=height, **pace)
        self._fixed = self.state.pace, before

    def give_size_back(self) -> None:
        """Trace again as the user has chosen, unless another choice was made meanwhile."""
        if self._fixed is not None and self._fixed[0] == self.state.pace:
            self.change(pace=self._fixed[1])
        self._fixed = None

    def restore(self, state: ViewState) -> None:
        """Go back to a state of the scene that is open; what belongs to this machine stays as it is."""
        if self.scene is None:
            return
        start, end = self.scene.time_range
        light = min(state.draw.light, max(len(self.scene.lights) - 1, 0))
        now = self.state
        here = replace(state, scene=now.scene, meshes=now.meshes, edits=now.edits, warmup=now.warmup,
                       compare=now.compare)  # fmt: skip
        here = replace(here, time=min(max(state.time, start), end)).with_draw(light=light)
        self.state, self.playing = here.on_machine_of(now), False
        self.want(state.edits, state.draw.light)

    def state_of(self, frame: Frame) -> ViewState:
        """Return the state that a frame shows, which may be of another moment, or of other edits, than this one."""
        on_path = self.on_path and self.scene is not None and frame.camera == self.scene.camera_at(frame.time)
        camera = None if on_path else frame.camera
        edits = self.edited.edits if self.edited is not None else NO_EDITS
        return replace(self.state, time=frame.time, camera=camera, settings=frame.settings, edits=edits)

    # --- the scene and its camera ----------------------------------------------------------------

    @property
    def on_path(self) -> bool:
        """Whether the camera goes along the scene's own path."""
        return self.state.camera is None

    @property
    def camera(self) -> Camera:
        """Where the picture is taken from."""
        if self.state.camera is not None:
            return self.state.camera
        scene = self.scene
        if scene is None:
            return NOWHERE
        kept = self._on_path
        if kept is None or kept[0] is not scene or kept[1] != self.time:  # it is asked for many times a frame
            kept = self._on_path = scene, self.time, scene.camera_at(self.time)
        return kept[2]

    def open(self, scene: Scene) -> None:
        """Look at another scene from its own first camera; settings and view stay, but for the radius of lamps, which
        is measured in units of the scene that was open."""
        if self.scene is not None and scene.path != self.scene.path:
            self.set_settings(lamp_radius=None)
            self.set_draw(zoom=FIT)
            self.give_size_back()
        self.scene = scene
        self.edited, self.light_to_come = edited(scene, NO_EDITS), None
        path = str(Path(scene.path).absolute())
        self.change(scene=path, edits=NO_EDITS, time=scene.time_range[0], camera=None)
        self.set_draw(light=min(self.draw.light, max(len(scene.lights) - 1, 0)))
        self.playing = False

    @property
    def original(self) -> Scene | None:
        """The scene as it was read."""
        return self.edited.original if self.edited is not None else self.scene

    def take(self, now: Edited) -> None:
        """Look at the same scene, edited otherwise; the chosen light stays, or becomes the one after it."""
        before, light = self.edited, self.draw.light
        if self.light_to_come is not None and now.edits == self.edits:
            light, self.light_to_come = self.light_to_come, None
        elif before is not None and light < len(before.lights):
            number = int(before.lights[light])
            light = int((now.lights < number).sum())
        self.scene, self.edited = now.scene, now
        self.set_draw(light=min(light, max(len(now.lights) - 1, 0)))

    def want(self, edits: Edits, light: int) -> None:
        """Want other edits, and this light of those that are on then."""
        if self.original is not None and self.edited is not None:
            self.change(edits=edits.within(self.original))
            self.light_to_come = light if self.edits != self.edited.edits else None

    @property
    def light_number(self) -> int:
        """The number of the chosen light in the scene as it was read."""
        return number_of(self.scene.lights, self.draw.light) if self.scene is not None else self.draw.light

    # --- time ------------------------------------------------------------------------------------

    @property
    def animated(self) -> bool:
        """Whether anything moves."""
        return self.scene is not None and self.scene.frames > 1 and self.scene.time_range[1] > self.scene.time_range[0]

    @property
    def frame(self) -> int:
        """The number of the frame whose time is nearest."""
        return self.frame_at(self.time)

    def frame_at(self, time: float) -> int:
        """Return the number of the frame whose time is nearest to some time in seconds."""
        if self.scene is None or not self.animated:
            return 0
        start, end = self.scene.time_range
        return round((time - start) / (end - start) * (self.scene.frames - 1))

    def go_to_frame(self, frame: int) -> None:
        """Go to the time of a frame."""
        if self.scene is not None:
            self.change(time=self.scene.frame_time(min(max(frame, 0), self.scene.frames - 1)))

    def advance(self, seconds: float, loop: bool) -> None:
        """Let time pass; at the end start again or stop."""
        if self.scene is None or not self.animated:
            self.playing = False
            return
        start, end = self.scene.time_range
        time = self.time + seconds
        if time > end:
            time = start + (time - start) % (end - start) if loop else end
            self.playing = loop
        self.change(time=time)

    def advance_frame(self, loop: bool) -> None:
        """Go on by one frame of the path; at the end start again or stop."""
        last = self.scene is None or not self.animated or self.frame + 1 >= self.scene.frames
        self.playing = self.animated and (loop or not last)
        if self.playing:
            self.go_to_frame(0 if last else self.frame + 1)
