"""Which requests show the same: the same view however finely, and with more recorded than is needed."""

from __future__ import annotations

from dataclasses import replace

from tracer.frame import Settings
from viewer.services.render_thread import RenderRequest

RECORDS = ("verify", "record_work", "record_lights")
"""Settings that only add to what a frame holds."""


def as_asked(settings: Settings, asked: Settings) -> Settings:
    """Settings at the size, with as much recorded and as much time for certificates, as others."""
    return replace(
        recording(settings, asked),
        width=asked.width,
        height=asked.height,
        modes=asked.modes,
        patient=asked.patient,
        samples=asked.samples,
        lamp_samples=asked.lamp_samples,
        certificate_seconds=asked.certificate_seconds,
    )


def recording(settings: Settings, other: Settings) -> Settings:
    """Settings with as much recorded as others."""
    return replace(settings, **{name: getattr(other, name) for name in RECORDS})


def lacks(had: Settings, wanted: Settings) -> bool:
    """Whether something is to be recorded that was not."""
    return any(getattr(wanted, name) and not getattr(had, name) for name in RECORDS)


def fulfils(made: RenderRequest, wanted: RenderRequest) -> bool:
    """Whether what answers one request answers another, as it holds the same or more."""
    as_made = replace(wanted, settings=recording(wanted.settings, made.settings))
    return as_made == made and not lacks(made.settings, wanted.settings)
