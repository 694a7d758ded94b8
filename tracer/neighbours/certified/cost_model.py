"""What certificates are worth: how eager to make and use them, by what a shadow ray costs.

A certificate takes as long to make as hundreds of shadow rays through the fast structure, but only as thirty through
the counted kd-tree, where a ray costs some 250 ns instead of 50.  So the kd-tree's model asks for fewer requests before
a cell is made, and its rays use a certificate in more ways.
"""

from __future__ import annotations

from typing import NamedTuple


class CostModel(NamedTuple):
    """How eager to make and use certificates.

    Attributes:
        root_requests: points that must have requested a triangle's first cell, its root, before that is made.
        split_requests: points that must have requested more of a cell before it is split into four.
        settled_candidates: candidates of a cell and a light, at most, for which the cell need not be split; 0 where
            rays never test candidates first.
        max_asked: candidates that a ray tests, at most, instead of traversing the tree; 0 for never.
        costly_rays: whether a ray costs so much that every look-up pays, even of a triangle without cells.
        stride: one in so many vectors of sixteen points makes requests, others in each frame.
        first_asking: the bounce from which on rays test candidates, 0 for primary hits.  The rays of those before are
            coherent, and tracing them in packets takes less time.
        least_samples: of a lamp whose rays are answered by beams; those of lamps with fewer are traced.
        ray_cost: nanoseconds that tracing a shadow ray takes, about; 0 where a few are traced to find out.
    """

    root_requests: int
    split_requests: int
    settled_candidates: int
    max_asked: int
    costly_rays: bool
    stride: int
    first_asking: int = 0
    least_samples: int = 2
    ray_cost: int = 250


# Measured on BART's scenes at 960x540, by accelerator.
_SINGLE_RAYS = CostModel(4, 12, 6, 48, True, 4)
COST_MODELS = {
    "kdtree": _SINGLE_RAYS,
    "kdtree-lazy": _SINGLE_RAYS,
    "bvh8": CostModel(8, 32, 0, 48, False, 16, 3, 8, 0),
}


def cost_model_for(accelerator: str, bounces: bool) -> CostModel:
    """The model for an accelerator's rays.  `bounces` tells whether anything reflects or refracts: where nothing does
    and rays are cheap, no ray tests candidates, as packets of rays from primary hits are traced for less."""
    model = COST_MODELS[accelerator]
    return model if model.costly_rays or bounces else model._replace(max_asked=0)
