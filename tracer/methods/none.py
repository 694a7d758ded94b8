"""No culling: every shadow ray that is due is traced.  The truth that every other method is held against."""

from __future__ import annotations

from tracer.methods.interface import ShadowMethod


class NoCulling(ShadowMethod):
    """Traces every shadow ray."""
