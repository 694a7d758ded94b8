"""The command `film`: a path of frames, or a flight through bookmarks, as numbered pictures and as a video.

Ctrl-C ends it after the last whole frame: the pictures so far stay, and the video is as long as these.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from tracer.renderer import Renderer
from tracer.scene.load import check_scene_file
from tracer.scene.model import Cancelled, Scene
from tracer.settings import Settings
from viewer.cli import arguments, options, pictures, processes
from viewer.cli.arguments import INTERRUPTED, Parser, number
from viewer.cli.console import Work, working
from viewer.output import capture, movie
from viewer.output.commands import needs_history
from viewer.services import film as films
from viewer.services import stills
from viewer.services.film import Script
from viewer.state import codec, navigation
from viewer.state.methods import CERTIFIED
from viewer.state.navigation import Stop, Take
from viewer.state.preferences import load_preferences
from viewer.state.view_state import ViewState
from viewer.util.files import check_writable
from viewer.util.messages import printable

EPILOG = """\
examples:
  shadowcull film kitchen.aff -o kitchen --size 1280x720 --samples 4
  shadowcull film kitchen.aff -o kitchen.mp4 --frames 100-300 --method certified --size 1920x1080
  shadowcull film default -o modes.mp4 --frames 0-49 --view occlusion --legend
  shadowcull film kitchen.aff -o flight.mp4 --through door.png table.png window.png --seconds 10
  shadowcull film kitchen.aff -o flight --bookmarks --fps 30

Every frame is traced whole, and each picture carries how it was made, for `shadowcull check`. Modes are learnt from
frame to frame. A flight moves evenly: each frame goes on as far as the others, where turning counts as well, and time
goes on from picture to picture. The video needs PyAV: install shadowcull[video]. An odd width or height of the video
is made even by repeating its last row or column. Ctrl-C keeps what is done; the exit code is then 130.
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
    help_ = "the frames A to B of the path, or one (default: all)"
    add("--frames", type=arguments.frame_span, metavar="A-B", help=help_)
    help_ = "fly through where these saved pictures were taken, at an even speed, in place of the path"
    add("--through", type=Path, nargs="+", metavar="PICTURE", help=help_)
    add("--bookmarks", action="store_true", help="fly through the scene's bookmarks, which the window keeps")
    help_ = "how long the film is (default: every frame of the path once; 2 seconds from bookmark to bookmark)"
    add("--seconds", type=number(0.01, 86_400.0), metavar="S", help=help_)
    add("--fps", type=number(1.0, 240.0), default=25.0, metavar="F", help="frames a second (default: 25)")
    processes.add_processes(parser)
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
    if video is not None:
        movie.check_video()
        check_writable(video)
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        state = pictures.wanted_state(scene, settings, given).with_warmup(
            frames=()
        )  # modes are learnt from the film alone
        stills.with_caption_filled(state, scene)  # or say now what is wrong with it
        pictures.check_tree(settings, state.draw.view, scene)
        pictures.check_lights(state, scene)
        takes = _takes(scene, _stops(scene, given), given)
        script = Script(takes, state, folder, video, given.fps)
        shared = _is_shared(state, given, work)
        if not shared:
            films.check_folder(folder)
        if given.scheduler is None or not shared:
            options.prepare_kernels(work, len(scene.lights), given.accelerator, settings.method)
        done = _by_processes(scene, script, given, work) if shared else _in_turn(scene, script, work)
        if done < len(takes):
            if not done:
                raise Cancelled("cancelled")
            work.note(f"cancelled after {done} of {len(takes)} frames; these are kept")
    for written in filter(None, (folder, video)):
        print(printable(written))
    return 0 if done == len(takes) else INTERRUPTED


def _in_turn(scene: Scene, script: Script, work: Work) -> int:
    """Trace frame after frame; returns how many there are, fewer than all where that was cancelled."""
    renderer = Renderer(scene, script.state.settings, work.progress)
    done, count = 0, len(script.takes)
    work.count(f"frame 1 of {count}", 0, count)
    with suppress(Cancelled):
        for done in films.write(script, films.in_turn(renderer, script, work.cancelled), note=work.note):
            work.count(f"frame {done} of {count}", done, count)
            if work.stopped and done < count:
                break
    return done


def _is_shared(state: ViewState, given: Namespace, work: Work) -> bool:
    """Whether several processes shall share the film, and can; raises ValueError, in one line, without Dask."""
    if given.workers is None and given.scheduler is None:
        return False
    from tracer.experiments.cluster import check_dask

    check_dask()
    if not needs_history(state):
        return True
    settings = state.settings
    exact = replace(state, settings=replace(settings, method=CERTIFIED))
    work.note(
        f"pictures by {settings.method} in the view {state.draw.view.value} depend on the frames before them: one "
        "process "
        f"traces them all, in turn{f'; give --method {CERTIFIED} to share them' if not needs_history(exact) else ''}"
    )
    return False


def _by_processes(scene: Scene, script: Script, given: Namespace, work: Work) -> int:
    """Trace what is missing of a film; returns how many pictures there are, fewer than all where that was cancelled."""
    kept, count = films.kept_pictures(script, scene), len(script.takes)
    done = len(kept)
    if kept:
        work.note(f"{done} of {count} pictures are there already; going on from there")
    with processes.cluster_of(given, count - done) as cluster:
        watch = processes.Watch(cluster, work)

        def show() -> None:
            watch.look()
            work.count(f"frame {min(done + 1, count)} of {count}, {watch}", done, count)

        show()
        pictures_ = films.by_processes(cluster, scene, script, kept, work.cancelled, show)
        with suppress(Cancelled):
            for done in films.write(script, pictures_, kept, work.note):  # noqa: B007 `show` tells it
                show()
    return done


def _takes(scene: Scene, stops: Sequence[Stop], given: Namespace) -> list[Take]:
    count = None if given.seconds is None else max(2, round(given.seconds * given.fps))
    if stops:
        start, end = scene.time_range
        for stop in stops:
            if not start <= stop.time <= end:
                raise ValueError(f"--through: a picture's time, {stop.time:g}, is none of the scene's")
        return navigation.through(stops, count or round(navigation.LEG * given.fps) * (len(stops) - 1) + 1)
    first, last = given.frames or (0, scene.frames - 1)
    return navigation.along_path(scene, first, last, count, given.camera)


def _stops(scene: Scene, given: Namespace) -> list[Stop]:
    """Return where a flight goes through, none for the scene's own path; raises ValueError in one line."""
    if sum([given.through is not None, given.bookmarks, given.frames is not None]) > 1:
        raise ValueError("film: give one of --frames, --through and --bookmarks")
    if given.through is not None:
        found, option = [Stop(*capture.read_camera(picture)) for picture in given.through], "--through"
    elif given.bookmarks:
        kept = load_preferences()[0].bookmarks.get(str(given.path.absolute()), [])
        states = [codec.state_from_json(bookmark.state) for bookmark in kept]
        found, option = (
            [Stop(state.time, state.camera or scene.camera_at(state.time)) for state in states],
            "--bookmarks",
        )
    else:
        return []
    if len(found) < 2:
        raise ValueError(f"{option}: {given.path.name} has {len(found)}; a flight needs two at least")
    return found
