"""The command `film`: a path of frames, or a flight through bookmarks, as numbered pictures and as a video.

Ctrl-C ends it after the last whole frame: the pictures so far stay, and the video is as long as these.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from tracer.frame import Frame
from tracer.renderer import Renderer
from tracer.scene.load import check_scene_file, load_visible_scene
from tracer.scene.model import Cancelled, Scene
from viewer.cli import film_elsewhere
from viewer.cli.console import Work, working
from viewer.cli.edit_options import edited_scene
from viewer.cli.mesh_arguments import mesh_options
from viewer.cli.render import check_display, check_tree, check_view, recipe_of
from viewer.cli.tracing_options import prepare_kernels, tracing_settings
from viewer.output import capture, movie
from viewer.services import filming, stills
from viewer.services.filming import Script
from viewer.state import flight
from viewer.state.flight import Stop, Take
from viewer.state.methods import default_for
from viewer.state.preferences import load_preferences
from viewer.state.session import Snapshot
from viewer.util.files import check_writable
from viewer.util.messages import printable


def film(path: Path, options: Namespace) -> bool:
    """Write a film; returns whether it was not stopped before its end.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no frame was finished."""
    check_scene_file(path)
    method = options.method or default_for(options.view.view)
    settings = replace(tracing_settings(options), method=method, samples=options.samples)
    check_view(settings, options.view.view)
    check_display(options)
    if options.output is None:
        raise ValueError("film: nothing to write; give -o FOLDER, or -o film.mp4")
    folder, video = filming.places(options.output)
    if video is not None:
        movie.check_video()
        check_writable(video)
    stops = _stops(path, options)
    with working() as work:
        read = load_visible_scene(path, work.progress, options.folder, mesh_options(options))
        scene = edited_scene(read, options)
        for warning in scene.warnings:
            work.note(f"warning: {warning}")
        recipe = replace(recipe_of(path, scene, settings, options), before=())  # modes are learnt from the film alone
        stills.check_light(recipe, scene)
        stills.with_caption_filled(recipe, scene)  # or say now what is wrong with it
        check_tree(settings, recipe.view, scene)
        if not stills.lights_fit(recipe, scene):
            raise ValueError(f"--view {recipe.view.value}: too many lights for pictures of this size")
        takes = _takes(scene, stops, options)
        script = Script(takes, recipe, folder, video, options.fps)
        shared = film_elsewhere.is_wanted(recipe, options, work)
        if not shared:
            filming.check_folder(folder)
        if options.scheduler is None or not shared:
            prepare_kernels(work, len(scene.lights), options.accelerator, settings.method)
        shoot = film_elsewhere.shoot if shared else _shoot
        done = shoot(scene, script, options, work)
        if done < len(takes):
            if not done:
                raise Cancelled("cancelled")
            work.note(f"cancelled after {done} of {len(takes)} frames; these are kept")
    for written in (folder, video):
        if written is not None:
            print(printable(written))
    return done == len(takes)


def _shoot(scene: Scene, script: Script, options: Namespace, work: Work) -> int:
    """Trace frame after frame; returns how many there are, fewer than all where that was cancelled."""
    renderer = Renderer(scene, script.recipe.settings, work.progress)
    done, count = 0, len(script.takes)

    def on_frame(number: int, frame: Frame) -> None:
        nonlocal done
        done = number + 1
        work.count(f"frame {done} of {count}", done, count)

    work.count(f"frame 1 of {count}", 0, count)
    with suppress(Cancelled):
        for _ in filming.shoot(renderer, script, work.cancelled, on_frame, work.note):
            if work.stopped and done < count:
                break
    return done


def _takes(scene: Scene, stops: Sequence[Stop], options: Namespace) -> list[Take]:
    count = None if options.seconds is None else max(2, round(options.seconds * options.fps))
    if stops:
        for stop in stops:
            start, end = scene.time_range
            if not start <= stop.time <= end:
                raise ValueError(f"--through: a picture's time, {stop.time:g}, is none of the scene's")
        return flight.through(stops, count or round(flight.LEG * options.fps) * (len(stops) - 1) + 1)
    first, last = options.frames or (0, scene.frames - 1)
    return flight.along_path(scene, first, last, count, options.camera)


def _stops(path: Path, options: Namespace) -> list[Stop]:
    """Where a flight goes through; none for the scene's own path.  Raises ValueError in one line."""
    given = [options.through is not None, options.bookmarks, options.frames is not None]
    if sum(given) > 1:
        raise ValueError("film: give one of --frames, --through and --bookmarks")
    if options.through is not None:
        found = [capture.read(picture) for picture in options.through]
        names = "--through"
    elif options.bookmarks:
        kept = load_preferences()[0].bookmarks.get(str(path.absolute()), [])
        found = [Snapshot.from_json(bookmark.get("state")) for bookmark in kept]
        names = "--bookmarks"
    else:
        return []
    if len(found) < 2:
        raise ValueError(f"{names}: {path.name} has {len(found)}; a flight needs two at least")
    return [Stop(snapshot.time, snapshot.camera) for snapshot in found]
