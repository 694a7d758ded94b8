"""The command `film`: a path of frames, or a flight through bookmarks, as numbered pictures and as a video.

Ctrl-C ends it after the last whole frame: the pictures so far stay, and the video is as long as these.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path

from tracer.experiments.camera_path import Stop
from tracer.geometry.world import World
from tracer.scene.load import check_scene_file
from tracer.scene.model import Scene
from tracer.settings import Settings
from tracer.util.text import printable
from viewer.cli import arguments, options, pictures
from viewer.cli.arguments import INTERRUPTED, Parser
from viewer.cli.console import working
from viewer.output import capture
from viewer.services import film as films
from viewer.services import stills
from viewer.state.plans import FilmPlan
from viewer.state.preferences import load_preferences

EPILOG = """\
examples:
  shadowcull film kitchen.aff -o kitchen --size 1280x720 --samples 4
  shadowcull film kitchen.aff -o kitchen.mp4 --frames 100-300 --method certified --size 1920x1080
  shadowcull film default -o modes.mp4 --frames 0-49 --view occlusion --legend
  shadowcull film kitchen.aff -o flight.mp4 --through door.png table.png window.png --seconds 10
  shadowcull film kitchen.aff -o flight --bookmarks --fps 30

Every frame is traced whole, and each picture carries how it was made, for `shadowcull check`. Modes are learnt from
frame to frame. A flight has an even speed, in which turning counts as well, and time goes on from picture to picture.
The video needs PyAV: install shadowcull[video]. If the width or height is odd, its last column or row is repeated.
Ctrl-C keeps what is done; the exit code is then 130.
"""


def parser() -> Parser:
    description = (
        "Trace the frames of a scene's path, or of a flight through bookmarks, into numbered pictures, and into a "
        "video."
    )
    parser = Parser("film", description, EPILOG + options.method_summaries())
    add = parser.add_argument
    options.add_scene(parser, pictures.OR_PICTURE)
    help_ = "a folder for the pictures; or film.mp4, whose pictures go to film-frames"
    add("-o", "--output", type=Path, metavar="DIR|FILE.mp4", help=help_)
    way = parser.add_mutually_exclusive_group()
    help_ = "the frames A to B of the path, or one (default: all)"
    way.add_argument("--frames", type=arguments.frame_span, metavar="A-B", help=help_)
    help_ = "fly through where these saved pictures were taken, at an even speed, in place of the path"
    way.add_argument("--through", type=Path, nargs="+", metavar="PICTURE", help=help_)
    help_ = "fly through the scene's bookmarks, which the window keeps"
    way.add_argument("--bookmarks", action="store_true", help=help_)
    options.add_settings(parser, FilmPlan, "seconds", "fps")
    pictures.add_picture(parser)
    options.add_tracing(parser)
    options.add_settings(parser, Settings, "verify")
    parser.set_defaults(frame=None, time=None, warmup=0, repeat=0, before=())
    return parser


def run(given: Namespace) -> int:
    """Write a film; raises SceneError, ValueError and OSError in one line, or Cancelled where no frame was finished."""
    check_scene_file(given.path)
    settings = pictures.picture_settings(given)
    if given.output is None:
        raise ValueError("film: nothing to write; give -o FOLDER, or -o film.mp4")
    folder, video = films.places(given.output)
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        state = pictures.wanted_state(scene, settings, given)
        state = state.with_warmup(frames=())  # modes are learnt from the film alone
        stills.with_caption_filled(state, scene)  # or say now what is wrong with it
        frames = given.frames or (0, scene.frames - 1)
        takes = films.takes(scene, frames, _stops(scene, given), given.seconds, given.fps, given.camera)
        films.prepare(folder, video)
        options.prepare_kernels(work, len(scene.lights), given.accelerator, settings.method)
        film = films.FilmRun(scene, takes, state, folder, video, given.fps)
        work.perform(film, World(scene, takes[0].time, settings.accelerator, work.progress))
        if film.remark:
            work.note(film.remark)
    for written in filter(None, (folder, video)):
        print(printable(written))
    return 0 if film.whole else INTERRUPTED


def _stops(scene: Scene, given: Namespace) -> Sequence[Stop] | None:
    """Where a flight goes through, None for the scene's own path; raises ValueError in one line."""
    if given.through is not None:
        return [Stop(*capture.read_camera(picture)) for picture in given.through]
    if not given.bookmarks:
        return None
    return films.stops_of(load_preferences()[0].bookmarks.get(str(given.path.absolute()), []), scene)
