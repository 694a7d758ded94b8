"""What a frame cost: counters that kernels add up, as named figures."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.counters import BY_LIGHT, PRIMARY, RAYS, SECONDARY, SHADOW, STEPS, TESTS, ShadowCounter
from tracer.culling.mode_changes import ModeChanges
from tracer.geometry.structure import BuiltPart

if TYPE_CHECKING:
    from tracer.visibility.budget import Counts


@dataclass
class RayCounts:
    """Counts for the rays of one kind.

    In the 8-wide trees, steps and tests are counted once for all rays of a packet, and a block of triangles is one
    test.

    Attributes
    ----------
    rays : int
        Rays that were traced.
    traversal_steps : int
        Nodes that these rays entered, inner nodes and leaves.
    intersection_tests : int
        Tests of a ray against a primitive.
    """

    rays: int = 0
    traversal_steps: int = 0
    intersection_tests: int = 0


@dataclass
class ShadowCounts(RayCounts):
    """Counts for shadow rays; `rays` are those that were traced through any tree.

    Attributes
    ----------
    due : int
        Shadow rays that had to be answered.
    culled : int
        Those that were not traced at all.
    dynamic_only : int
        Those of which nothing was known but that nothing static is in the way, in shadow rays: they were tested against
        dynamic objects only. Where there are none, or all of them rest and the method takes what rests for static,
        nothing is asked: they count here, but are not among `rays`.
    candidates_only : int
        Those that were tested against a few candidates instead of the static tree.
    cache_hits : int
        Those that a cached occluder blocked.
    wrong : int
        Those whose answer is wrong, counted with `Settings.verify`. As all these counts, of the first sample of each
        pixel; `FrameStatistics.wrong` is of all.
    passed_over : int
        Pairs of a point and a light's sample that nobody looked at, as it is proved that the light does not reach any
        point nearby. They are not among those that are due. Where the light of each is recorded or verified, nothing
        is passed over: such rays are due, and culled.
    """

    due: int = 0
    culled: int = 0
    dynamic_only: int = 0
    candidates_only: int = 0
    cache_hits: int = 0
    wrong: int = 0
    passed_over: int = 0

    @property
    def saved(self) -> int:
        """Those that asked nothing static: culled, or tested against dynamic objects only."""
        return self.culled + self.dynamic_only

    @property
    def traced(self) -> int:
        """Those of which nothing was known: all that are due but were neither saved, nor tested against candidates
        only, nor blocked by a cached occluder."""
        return self.due - self.saved - self.candidates_only - self.cache_hits


@dataclass
class WrongCounts:
    """What verifying has found, in all samples of all pixels that are shaded.

    A shadow answer is wrong if tracing the ray through the whole scene gives another one, and a pixel is wrong if any
    answer that counts for it is: to any light, at any bounce, in any sample. Clusters of lights give no wrong answers;
    with them a pixel is wrong that differs by more than `Settings.lightcuts_error`.

    Attributes
    ----------
    answers : int
        Wrong answers.
    due : int
        Shadow rays that had to be answered.
    untraced : int
        Those of them of which anything was known (`ShadowCounts.traced`): no other answer can be wrong.
    pixels : int
        Wrong pixels.
    shaded : int
        Pixels that are shaded, and so verified.
    samples : int
        Samples of each pixel.
    """

    answers: int = 0
    due: int = 0
    untraced: int = 0
    pixels: int = 0
    shaded: int = 0
    samples: int = 1


@dataclass
class SaidByModes:
    """What the paper's method would do with the shadow rays of one light, whichever method culls.

    Attributes
    ----------
    due : int
        Shadow rays that had to be answered.
    full_shadow : int
        Those that the paper's method culls.
    non_shadow : int
        Those that it tests against dynamic objects only.
    """

    due: int = 0
    full_shadow: int = 0
    non_shadow: int = 0

    @property
    def saved(self) -> int:
        """Those that would ask nothing static."""
        return self.full_shadow + self.non_shadow


@dataclass
class SampleCounts:
    """What the lights send to the primary hits of a frame.

    Attributes
    ----------
    due : int
        Samples of lights that primary hits face.
    reached : int
        Those of them that reach the hit.
    penumbra : int
        Pixels that some samples of a light reach, but not all that they face.
    """

    due: int = 0
    reached: int = 0
    penumbra: int = 0


def sample_counts(asked: NDArray[np.uint16], reached: NDArray[np.uint16]) -> SampleCounts:
    """Count what was recorded of (pixels, lights)."""
    partly = reached < asked
    partly &= reached > 0
    due, arrived = (int(samples.sum(dtype=np.int64)) for samples in (asked, reached))
    return SampleCounts(due, arrived, int(np.count_nonzero(partly.any(axis=1))))


@dataclass
class CutErrors:
    """By how much a picture shaded by cuts differs from that of all lights, as a part of the latter, pixel by pixel.

    Colours are sums of three channels. What is darker than 1/64 is taken for that bright, and what misses everything is
    left out.

    Attributes
    ----------
    median, most_of, most : float
        What half of the pixels, 95 % of them and all of them do not exceed.
    beyond : int
        Pixels that differ by more than `Settings.lightcuts_error`.
    """

    median: float = 0.0
    most_of: float = 0.0
    most: float = 0.0
    beyond: int = 0


@dataclass
class CutCounts:
    """What the cuts of a frame were, by a method that shades by clusters of lights.

    Attributes
    ----------
    lights : int
        Lights, each sample of a lamp one.
    blocks : int
        Blocks of up to 128 points that have a cut, at all bounces.
    nodes : int
        Clusters of all their cuts.
    limited : int
        Blocks whose cuts have as many nodes as they may, so that their error may be greater than was asked for.
    most : int
        Nodes of the largest cut.
    errors : CutErrors or None
        How wrong the picture is; with `Settings.verify`.
    """

    lights: int = 0
    blocks: int = 0
    nodes: int = 0
    limited: int = 0
    most: int = 0
    errors: CutErrors | None = None

    @property
    def mean(self) -> float:
        """Nodes of a cut on average."""
        return self.nodes / max(1, self.blocks)


@dataclass
class FrameStatistics:
    """Counters and times of one frame.

    Attributes
    ----------
    primary, secondary : RayCounts
        Rays from the camera, and reflected or refracted ones.
    shadow : ShadowCounts
        Shadow rays.
    occlusion_tests : int
        Extra tests between neighbouring pixels (§2.3), of a method that culls by modes. Where modes are kept beside a
        method (`Settings.modes`), they are only looked at: their tests and the time of these are not the method's.
    certificates, certificate_steps, certificate_tests : int
        Certificates that were made, and the steps and tests that they took; or what a method makes in their place
        (`tracer.method.Kind.makes`).
    part : float
        The part of the pixels that were shaded. Below 1, shadow and secondary rays are those of this part.
    decision : str
        What the method does now and why, and what of the scene it has nothing to say of, in a sentence or two.
    light_buffers : list of int
        How many cells an edge of each light's cube has, 0 for a light that is traced; for the method "lightbuffer".
    samples : SampleCounts or None
        What the lights send to the primary hits; with `Settings.record_lights`.
    built : BuiltPart or None
        How much of the tree there is after this frame; None for trees that are built before rays come.
    cuts : CutCounts or None
        What cuts of lights there were; with methods that have them.
    wrong : WrongCounts or None
        What is wrong, with `Settings.verify`.
    seconds : float
        Time of the whole frame, without that of modes that are only looked at.
    by_modes : list of SaidByModes
        For each light that has modes; empty if none are kept.
    mode_changes : ModeChanges or None
        How modes changed in this frame; None if none are kept.
    resting : int
        Primitives of dynamic objects that rest, by a method for which these count as static: they carry modes.
    phases : dict of str to float
        Seconds of each phase of Figure 1.
    """

    primary: RayCounts = field(default_factory=RayCounts)
    secondary: RayCounts = field(default_factory=RayCounts)
    shadow: ShadowCounts = field(default_factory=ShadowCounts)
    occlusion_tests: int = 0
    certificates: int = 0
    certificate_steps: int = 0
    certificate_tests: int = 0
    part: float = 1.0
    decision: str = ""
    light_buffers: list[int] = field(default_factory=list)
    samples: SampleCounts | None = None
    built: BuiltPart | None = None
    cuts: CutCounts | None = None
    wrong: WrongCounts | None = None
    seconds: float = 0.0
    by_modes: list[SaidByModes] = field(default_factory=list)
    mode_changes: ModeChanges | None = None
    resting: int = 0
    phases: dict[str, float] = field(default_factory=dict)

    def add_made(self, made: Counts) -> None:
        """Count what one of the frame's methods has made, and what that took."""
        self.certificates += made.certificates
        self.certificate_steps += made.steps
        self.certificate_tests += made.tests

    def say(self, sentence: str) -> None:
        """Add to what the method says of the frame; nothing, where it is empty."""
        self.decision = " ".join(filter(None, (self.decision, sentence)))

    @property
    def traversal_steps(self) -> int:
        """Those of rays of all kinds."""
        return sum(rays.traversal_steps for rays in (self.primary, self.secondary, self.shadow))

    @property
    def intersection_tests(self) -> int:
        """Those of rays of all kinds."""
        return sum(rays.intersection_tests for rays in (self.primary, self.secondary, self.shadow))

    @property
    def by_modes_in_all(self) -> SaidByModes:
        """The sum over the lights."""
        one = self.by_modes
        return SaidByModes(sum(s.due for s in one), sum(s.full_shadow for s in one), sum(s.non_shadow for s in one))

    def to_dict(self) -> dict:
        """Plain dictionaries and numbers, for JSON."""
        return asdict(self)


def shadow_counts(counts: NDArray[np.int64]) -> ShadowCounts:
    """The shadow counters (SHADOW_COUNTERS,) of one worker, or their sum, by name."""
    return ShadowCounts(**{counter.name.lower(): int(counts[counter]) for counter in ShadowCounter})


def gather(counts: NDArray[np.int64], occlusion_tests: int, lights_with_modes: int) -> FrameStatistics:
    """Sum the counters (workers, COUNTERS) of all workers."""
    total = counts.sum(0)

    def rays_from(start: int) -> RayCounts:
        return RayCounts(int(total[start + RAYS]), int(total[start + STEPS]), int(total[start + TESTS]))

    rays = rays_from(PRIMARY), rays_from(SECONDARY), shadow_counts(total[SHADOW:])
    by_light = range(SHADOW + BY_LIGHT, len(total), 3)[:lights_with_modes]
    by_modes = [SaidByModes(*(int(number) for number in total[at : at + 3])) for at in by_light]
    return FrameStatistics(*rays, occlusion_tests, by_modes=by_modes)
