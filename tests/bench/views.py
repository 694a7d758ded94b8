"""The contest of rays: sets of rays of one kind, view by view along a scene's path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.bench.any_hit_rays import ANY_HITS, any_hit_rays
from tests.bench.contest import Embreex, Ours, Spread, differing, heats, oracle, race, second_core, thread_numbers
from tests.bench.embree import EmbreeRays, EmbreeScene
from tests.bench.rays import Surfaces, incoherent_rays, joined, mirror_rays, points_of, primary_rays, shadow_rays
from tracer.geometry.rays import Rays
from tracer.geometry.world import World

KINDS = ("primary", "shadow", "mirror", "incoherent")
SINGLE = "incoherent"  # the kind for which Embree's single-ray call is the measure


@dataclass
class Contest:
    """One kind of rays in one view: seconds of each round, also for the nearest hits of those in ANY_HITS, and how many
    answers differ from robust Embree's, of ours and of the Embree that was timed."""

    kind: str
    time: float
    rays: int
    opponent: str
    ours: list[float]
    embree: list[float]
    two: list[float]
    nearest: list[float]
    second_core: list[float]
    heats: dict[str, float]
    differing: int
    differing_strictly: int
    embree_differing: int

    def ratio(self) -> Spread:
        """Our rate over Embree's, round by round."""
        return Spread.of(np.array(self.embree) / np.array(self.ours))

    def rate(self, seconds: list[float]) -> Spread:
        """Millions of rays a second."""
        return Spread.of(self.rays / np.array(seconds) / 1e6)

    def to_json(self) -> dict[str, Any]:
        return vars(self) | {
            "ratio": self.ratio().to_json(),
            "ours_million_rays": self.rate(self.ours).to_json(),
            "embree_million_rays": self.rate(self.embree).to_json(),
        }


def ray_sets(world: World, surfaces: Surfaces, time: float, size: int, seed: int) -> dict[str, Rays]:
    """The rays of each kind for a view by the scene's own camera, `size` pixels wide and high."""
    scene = world.scene
    primary = primary_rays(scene.camera_at(time), size, size)
    points = points_of(surfaces, primary, world.closest_hits(primary))
    shadow = [shadow_rays(points, light)[0] for light in scene.light_positions(time).astype(np.float32)]
    return {
        "primary": primary,
        "shadow": joined(shadow),
        "mirror": mirror_rays(points),
        "incoherent": incoherent_rays(world.bounds(), size * size, seed),
        **any_hit_rays(world, time, points, joined(shadow[:1]), size, seed),
    }


def contests(world: World, time: float, size: int, rounds: int, trials: int, seed: int) -> list[Contest]:
    """All kinds in one view.  Embree's best mode is that with the least time in `trials` runs of each."""
    world.place(time)
    surfaces = Surfaces.of(world.scene, time)
    triangles = surfaces.triangles()
    embree, robust = EmbreeScene(triangles), EmbreeScene(triangles, robust=True)
    made = []
    for kind, rays in ray_sets(world, surfaces, time, size, seed).items():
        if not len(rays.t_min):
            continue
        closest = kind != "shadow" and kind not in ANY_HITS
        tried = heats(embree, rays, closest, trials)
        best = next(mode for mode in tried if kind != SINGLE or mode.width == 1)
        opponents: list[Any] = [EmbreeRays(embree, rays, closest, best)]
        if kind == SINGLE:
            opponents.append(Embreex(triangles, rays))
        ours = [Ours(world, rays, closest, threads) for threads in thread_numbers()]
        nearest = [Ours(world, rays, True)] if kind in ANY_HITS else []
        times, core = race([*ours, *opponents, *nearest], rounds, second_core if len(ours) > 1 else None)
        against = times[len(ours) : len(ours) + len(opponents)]
        truth = oracle(robust, rays, closest)
        winner = int(np.median(against, axis=1).argmin())
        made.append(
            Contest(
                kind=kind,
                time=time,
                rays=len(rays.t_min),
                opponent=opponents[winner].name,
                ours=times[0].tolist(),
                embree=against[winner].tolist(),
                two=times[1].tolist() if len(ours) > 1 else [],
                nearest=times[-1].tolist() if nearest else [],
                second_core=core.tolist() if len(ours) > 1 else [],
                heats={str(mode): len(rays.t_min) / seconds / 1e6 for mode, seconds in tried.items()},
                differing=differing(rays, ours[-1].answers(), truth),
                differing_strictly=differing(rays, ours[-1].answers(), truth, offset=0.0),
                embree_differing=differing(rays, opponents[0].answers(), truth),
            )
        )
    return made
