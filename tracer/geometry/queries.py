"""The queries that everything above geometry calls on a placed world, whichever structure is below."""

from tracer.geometry.kdtree.traverse import any_dynamic_hits, any_static_hits, closest_hits, hits_alone

__all__ = ["any_dynamic_hits", "any_static_hits", "closest_hits", "hits_alone"]
