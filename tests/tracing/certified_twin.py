"""The naive twin of certificates: what rays that end in a cell really meet, by dense sampling.

Points are strewn over a cell, at its corners and along its edges, as low and as high above it as look-up lets rays
end.  Those that look-up, told anew here, finds in another cell are left out.  Shadow rays to the others
are asked of both structures, and of every static primitive in turn.
"""

from __future__ import annotations

import numpy as np

import tracer
from tests.sweeps import ACCELERATORS
from tests.tracing.brute import meet_all
from tracer.geometry.rays import RAY_OFFSET, ray_batch
from tracer.neighbours.certified.cell_prism import LOWEST
from tracer.neighbours.certified.cells import CANDIDATES, FULL, LIT, named_by, state_of
from tracer.neighbours.certified.store import CertificateStore
from tracer.runtime.kernels import kernel
from tracer.simd import address_of, load_columns, load_three
from tracer.visibility.error_bounds import EPSILON
from tracer.visibility.light_space import LIGHT_ROW, verdicts
from tracer.visibility.static_geometry import HIGHEST

LAMP = 1e-5  # of the way from the light: where shadow rays begin
NAMES = {FULL: "FULL", LIT: "LIT", CANDIDATES: "CANDIDATES"}


class Twin:
    """Certificates of a scene in which nothing moves, and that scene for rays."""

    def __init__(self, scene: tracer.Scene, certificates: CertificateStore, lights: np.ndarray) -> None:
        assert len(scene.objects) == 1
        self.worlds = {name: tracer.World(scene, accelerator=name) for name in ACCELERATORS}
        self.certificates, self.lights = certificates, np.asarray(lights, np.float32)
        self.cells, self.rows = certificates.cells, certificates.occluders.rows
        self.light_space = certificates.occluders.light_space
        world = self.worlds["kdtree"]
        self.primitives = len(world.object_of)
        used = int(self.cells.used[0])
        roots = 1 + np.flatnonzero(self.cells.parent[1:used] == 0)
        self.roots = dict(zip(self.cells.owner[roots].tolist(), roots.tolist(), strict=True))
        self.largest = certificates.scale.max_height / (HIGHEST * RAY_OFFSET)

    def certificates_made(self) -> np.ndarray:
        """All (cell, light, state) there are, (n, 3)."""
        used = int(self.cells.used[0])
        states = _states(self.cells.words[:used], len(self.lights))
        cell, light = np.nonzero(states)
        return np.stack([cell, light, states[cell, light]], 1)

    def names(self, cell: int, light: int) -> np.ndarray | None:
        """The primitives that a certificate names; None for too many."""
        return named_by(self.cells, cell, light)

    def cells_of(self, owner: int, points: np.ndarray) -> np.ndarray:
        """(n,) the leaves that rays to points (n, 3) are looked up in, all on one side of a triangle; 0 for none."""
        row = self.rows[owner >> 1].astype(np.float64)
        a, e1, e2 = row[:3], row[3:6], row[6:9]
        n = np.cross(e1, e2)
        across = np.linalg.norm(n)
        dual = [np.cross(e2, n) / across**2, np.cross(n, e1) / across**2, n / across]
        along_u, along_v, normal = (d.astype(np.float32) for d in dual)
        x = points - a.astype(np.float32)
        u, v, height = (_dot(d, x) for d in (along_u, along_v, normal))
        beyond = [np.float32(3 * EPSILON * self.largest * np.linalg.norm(e) / across) for e in (e2, e1)]
        above = np.abs(height)
        inside = (above >= np.float32(LOWEST * RAY_OFFSET) * np.abs(points).max(1)) & (
            above <= self.certificates.scale.max_height
        )
        inside &= (height > 0) if owner & 1 == 0 else (height < 0)
        inside &= (u >= -beyond[0]) & (v >= -beyond[1]) & (u + v <= np.float32(1) + beyond[0] + beyond[1])
        found = np.array([self._leaf(self.roots[owner], *at) for at in zip(u.clip(0, 1), v.clip(0, 1), strict=True)])
        return np.where(inside, found, 0)

    def _leaf(self, cell: int, u: np.float32, v: np.float32) -> int:
        half, one = np.float32(0.5), np.float32(1)
        while self.cells.child[cell] >= 0:
            first = int(self.cells.child[cell])
            if u + v <= half:
                part, u, v = 0, u + u, v + v
            elif u >= half:
                part, u, v = 1, u + u - one, v + v
            elif v >= half:
                part, u, v = 2, u + u, v + v - one
            else:
                part, u, v = 3, one - (u + u), one - (v + v)
            cell = first + part
        return cell

    def is_in(self, cell: int, leaves: np.ndarray) -> np.ndarray:
        """Which of the leaves (n,) are the cell, or parts of it."""
        at, inside = leaves.copy(), leaves == cell
        while at.any():
            at = self.cells.parent[at]
            inside |= (at == cell) & (at != 0)
        return inside

    def points_in(self, cell: int, rng: np.random.Generator, count: int) -> np.ndarray:
        """Points (n, 3) float32 where rays that end in a cell may end."""
        owner, (u, v, size) = int(self.cells.owner[cell]), self.cells.place[cell].astype(np.float64)
        row = self.rows[owner >> 1].astype(np.float64)
        a, e1, e2 = row[:3], row[3:6], row[6:9]
        normal = np.cross(e1, e2) * (1 - 2 * (owner & 1))
        normal /= np.linalg.norm(normal)
        weights = _weights(rng, count)
        x, y = u + weights[:, 1] * size, v + weights[:, 2] * size
        at = a + x[:, None] * e1 + y[:, None] * e2
        largest, highest = np.abs(at).max(1), self.certificates.scale.max_height
        kind = rng.integers(5, size=len(at))
        low = LOWEST * RAY_OFFSET * largest
        rise = [
            low * (1 + 1e-6),
            low * 1.001,
            2.0 * low,
            np.full(len(at), highest * (1 - 1e-6)),
            rng.uniform(low, highest),
        ]
        points = (at + np.choose(kind, rise)[:, None] * normal).astype(np.float32)
        return points[self.is_in(cell, self.cells_of(owner, points))]

    def failures(self, chosen: np.ndarray, rng: np.random.Generator, count: int, brute: bool = True) -> list[str]:
        """What rays say otherwise than certificates (n, 3), (cell, light, state); with `brute`, every primitive is
        asked about in turn as well.  Of how many rays to cells of each state, `tried` tells."""
        points = [self.points_in(int(cell), rng, count) for cell, _, _ in chosen]
        which = np.repeat(np.arange(len(chosen)), [len(p) for p in points])
        self.tried = np.bincount(chosen[which, 2], minlength=4)
        if not len(which):
            return []
        ends = np.concatenate(points)
        starts = self.lights[chosen[which, 1]]
        asked = _Asked(self, starts, ends, brute)
        result = []
        for k, (cell, light, state) in enumerate(chosen.tolist()):
            rays = np.flatnonzero(which == k)
            if len(rays):
                result += self._failures_of(cell, light, state, asked, rays)
        return result

    def _failures_of(self, cell: int, light: int, state: int, asked: _Asked, rays: np.ndarray) -> list[str]:
        names = np.empty(0, np.int32) if state == LIT else self.names(cell, light)
        wrong = []
        for name, blocked in asked.blocked.items():
            if state == FULL:
                wrong += [(f"not blocked in {name}", rays[~blocked[rays]])]
            elif names is not None:
                met = asked.met[name][rays]
                wrong += [(f"unnamed blocks in {name}", rays[(met >= 0) & ~np.isin(met, names)])]
                if state == LIT:
                    wrong += [(f"blocked in {name}", rays[blocked[rays]])]
                else:
                    wrong += self._wrong_verdicts(names, light, name, asked, rays)
        if asked.meets is not None and names is not None and state != FULL:
            unnamed = np.ones(self.primitives, np.bool_)
            unnamed[names] = False
            wrong += [("an unnamed primitive is hit", rays[(asked.meets[rays] & unnamed).any(1)])]
        return [
            f"cell {cell}, light {light}, {NAMES[state]}: {what}, {len(these)} of {len(rays)} rays, "
            f"as to {asked.ends[these[0]].tolist()}"
            for what, these in wrong
            if len(these)
        ]

    def _wrong_verdicts(self, names, light: int, name: str, asked: _Asked, rays: np.ndarray) -> list:
        if not len(names):
            return []
        hits, misses = np.empty((2, len(names), len(rays)), np.bool_)
        ends = np.ascontiguousarray(asked.ends[rays].T, np.float32)
        _verdicts(self.light_space[light], names, self.lights[light], ends, hits, misses)
        hit, missed = hits.any(0), misses.all(0)
        blocked = asked.blocked[name][rays]
        assert not (hits & misses).any()
        return [
            (f"sure hits miss in {name}", rays[hit & ~blocked]),
            (f"sure misses hit in {name}", rays[missed & blocked]),
        ]


class _Asked:
    """Shadow rays and what they meet: blocked (n,) and met (n,), the nearest primitive, by structure; meets (n,
    primitives), whether each is met."""

    def __init__(self, twin: Twin, starts: np.ndarray, ends: np.ndarray, brute: bool) -> None:
        self.ends = ends
        rays = ray_batch(starts, ends - starts, LAMP, 1.0)
        self.blocked = {name: world.any_hits(rays) for name, world in twin.worlds.items()}
        self.met = {name: world.closest_hits(rays).primitive for name, world in twin.worlds.items()}
        self.meets = None
        if brute:
            self.meets = np.isfinite(meet_all(twin.worlds["kdtree"], rays, np.ones(twin.primitives, np.bool_)).t)


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[0] * b[:, 0] + a[1] * b[:, 1] + a[2] * b[:, 2]


def _weights(rng: np.random.Generator, count: int) -> np.ndarray:
    """Barycentric coordinates (n, 3) in a cell: its corners, its edges, just beside these, and all over."""
    inner = rng.dirichlet((1, 1, 1), count // 3)
    edges = rng.dirichlet((1, 1, 1), count // 2)
    edges[np.arange(len(edges)), rng.integers(3, size=len(edges))] = rng.choice(
        [0.0, 0.0, 1e-7, 1e-6, 1e-4], len(edges)
    )
    corners = np.eye(3)[rng.integers(3, size=count - len(inner) - len(edges))]
    corners[len(corners) // 2 :] += 10.0 ** rng.uniform(-8, -4, (len(corners) - len(corners) // 2, 3))
    made = np.concatenate([inner, edges, corners])
    return made / made.sum(1, keepdims=True)


@kernel
def _states(words, lights):
    states = np.empty((len(words), lights), np.int64)
    for i in range(len(words)):
        for light in range(lights):
            states[i, light] = state_of(words[i], light)
    return states


@kernel
def _verdicts(light_space, names, light, ends, hits, misses):
    """hits and misses (names, n): of which rays to ends (3, n) each of sights (any, SIGHT) is certain."""
    numbers, padded = np.zeros(16, np.int32), np.zeros((3, 16), np.float32)
    for first in range(0, ends.shape[1], 16):
        count = min(16, ends.shape[1] - first)
        padded[:, :count] = ends[:, first : first + count]
        for j in range(len(names)):
            numbers[:] = names[j]
            end = load_three(padded, 0)
            direction = end[0] - light[0], end[1] - light[1], end[2] - light[2]
            hit, missed = verdicts(
                load_columns(address_of(light_space), address_of(numbers), LIGHT_ROW), light, direction, end
            )
            for k in range(count):
                hits[j, first + k], misses[j, first + k] = (hit >> k) & 1, (missed >> k) & 1
