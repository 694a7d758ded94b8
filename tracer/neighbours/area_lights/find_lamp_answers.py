"""Answer the shadow rays of lamps: for all samples of a lamp at once, before any of them is traced.

Points that are shaded together are neighbours, and a lamp's samples are, too.  So what may come between is looked for
only once for all of their rays: in the tree for a group of vectors, with a beam around it (`beams`), and then vector by
vector in what was found.  Where points lie so far apart that too much comes between, as those that mirrors show, each
vector goes through the tree by itself, and then each point (`area_light_query`).

All of that is bounded by what the rays would take: where beams save less than they take, rays are traced.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.shadow_testing import may_face
from tracer.culling.stages import vectors
from tracer.neighbours.area_lights.area_light_query import (
    ALL_KEPT,
    ALL_PREPARED,
    EACH_POINT,
    EFFORT,
    FOR_BEAM,
    FOR_POINTS,
    HIDING,
    LATEST,
    MARKS,
    NUMBERS,
    OF_GROUP,
    OF_VECTOR,
    STATE,
    UNSURE,
    Scratch,
    ask_each,
    ask_vector,
    batches_of,
    find_primitives,
)
from tracer.neighbours.area_lights.lamp_answers import decided
from tracer.neighbours.area_lights.ray_cost import cost_of_rays
from tracer.runtime.kernels import subkernel
from tracer.simd import i64_at, lanes_below, local_memory, ones
from tracer.visibility.area_light_tests import SAMPLES, put_samples
from tracer.visibility.beams import make_beam, passes_by, put_beam
from tracer.visibility.error_bounds import LANES
from tracer.visibility.prepared_triangles import PREPARED, Lamp, prepare_in_tree

GROUP = 8  # vectors of points with one way through the tree
# Of a vector's rays: what beams may take before they have saved anything, at most what counts of what they have saved,
# and what a group that is passed over counts as saved.
ADVANCE, SAVINGS, PARDON = 4, 16, 1


@subkernel
def find_answers(lamps, points, answers, batch, samples, first, number, count, counts):
    """Find what is known of `count` points and lamp `number`, whose samples are those of (any, 3) from the first on.

    lamps is a `LampsView`.  A few rays are traced, which have their place in batch, a `ShadowBatch`."""
    o, beam, place, radius = lamps.occluders, make_beam(), lamps.places[number], lamps.radii[number]
    light, many = (place[0], place[1], place[2]), np.int64(lamps.samples[number])
    scratch = Scratch(
        samples=local_memory(SAMPLES),
        numbers=local_memory(NUMBERS),
        prepared=local_memory(ALL_PREPARED),
        kept=local_memory(ALL_KEPT),
        entries=local_memory(UNSURE),
        blocked=local_memory(MARKS),
        unsure=local_memory(MARKS),
        state=local_memory(STATE),
        hiding=local_memory(PREPARED),
        often=local_memory(EACH_POINT),
        asked=local_memory(EACH_POINT),
    )
    lamp = Lamp(number, light, radius, put_samples(samples, first, many, light, scratch.samples))
    state = i64_at(scratch.state)
    state[EFFORT], state[LATEST], state[HIDING] = 0, -1, 0
    for v in range(vectors(count)):
        answers.open[v] = may_face(points, light, radius, v) & lanes_below(count, v)
    ray_cost = cost_of_rays(lamps, points, answers.open, batch, samples[first], many, count, counts)
    cost = many * ray_cost  # of a point's rays
    most = min(OF_VECTOR, LANES * cost // FOR_POINTS)
    balance = ADVANCE * LANES * cost
    for start in range(0, vectors(count), GROUP):
        end = min(start + GROUP, vectors(count))
        some = 0
        for v in range(start, end):
            answers.full[v] = answers.lit[v] = answers.partly[v] = answers.alone[v] = 0
            some += answers.open[v] != 0
        if some == 0:
            continue
        if balance < 0:  # beams do not pay here
            balance += PARDON * LANES * cost
            continue
        found = np.int64(-1)
        if some > 1 and put_beam(beam, points, answers.open, start, end, light, radius, lamps.within):
            found = find_primitives(o, number, beam, min(OF_GROUP, most), scratch, counts)
            for k in range(batches_of(found)):
                prepare_in_tree(o, lamp, scratch.numbers + 64 * k, scratch.prepared + PREPARED * k)
        state[LATEST] = -1
        away = found >= 0 and passes_by(beam, lamps.unknown)
        for v in range(start, end):
            if answers.open[v] == 0 or balance < 0:
                continue
            if away and found == 0:
                answers.lit[v] = answers.alone[v] = answers.open[v]
            elif put_beam(beam, points, answers.open, v, v + 1, light, radius, lamps.within):
                state[EFFORT] += FOR_BEAM
                known = found if found >= 0 else find_primitives(o, number, beam, most, scratch, counts)
                if known >= 0:
                    if away or passes_by(beam, lamps.unknown):
                        answers.alone[v] = answers.open[v]
                    ask_vector(o, points, answers, v, lamp, beam, known, found > 0, cost, scratch, counts)
                else:
                    ask_each(o, points, answers, v, lamp, lamps, cost, scratch, counts)
            elif found < 0:
                ask_each(o, points, answers, v, lamp, lamps, cost, scratch, counts)
            # A packet with half its rays left takes more than half the time: the more are known, the more each saves.
            answered, due = decided(answers, v, many), many * ones(np.int64(answers.open[v]))
            saved = ray_cost * answered * answered // due
            balance = min(balance + saved - state[EFFORT], SAVINGS * LANES * cost)
            state[EFFORT] = 0
