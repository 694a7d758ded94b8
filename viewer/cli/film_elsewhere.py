"""Films whose pictures several processes share: `film --workers` and `film --scheduler`."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace

from tracer.scene.model import Cancelled, Scene
from viewer.cli.console import Work
from viewer.output.recipe import Recipe
from viewer.services.filming import Script, make_folder
from viewer.state.methods import CERTIFIED


def is_wanted(recipe: Recipe, options: Namespace, work: Work) -> bool:
    """Whether several processes are to share the film, and can; raises ValueError, in one line, without Dask."""
    if options.workers is None and options.scheduler is None:
        return False
    from tracer.experiments.cluster import check_dask
    from viewer.services.films_elsewhere import filmed_alone

    check_dask()
    if filmed_alone(recipe):
        return True
    settings = recipe.settings
    exact = replace(recipe, settings=replace(settings, method=CERTIFIED))
    work.note(
        f"pictures by {settings.method} in the view {recipe.view.value} depend on the frames before them: one process "
        f"traces them all, in turn{f'; give --method {CERTIFIED} to share them' if filmed_alone(exact) else ''}"
    )
    return False


def shoot(scene: Scene, script: Script, options: Namespace, work: Work) -> int:
    """Trace what is missing of a film; returns how many pictures there are, fewer than all where that was cancelled."""
    from viewer.cli.processes import Watch, cluster_of
    from viewer.services import films_elsewhere

    make_folder(script.folder)
    kept, count = films_elsewhere.kept_pictures(script, scene), len(script.takes)
    done = len(kept)
    if kept:
        work.note(f"{done} of {count} pictures are there already; going on from there")
    with cluster_of(options, count - done) as cluster:
        watch = Watch(cluster, work)

        def on_progress(now: int) -> None:
            nonlocal done
            done = now
            watch.look()
            work.count(f"frame {min(now + 1, count)} of {count}, {watch}", now, count)

        on_progress(done)
        try:
            for _ in films_elsewhere.shoot(cluster, scene, script, kept, work.cancelled, on_progress, work.note):
                pass
        except Cancelled:
            pass
    return done
