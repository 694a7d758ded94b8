"""What a request asks for, and which requests show the same: the same view however finely, and with more recorded than
is needed."""

from __future__ import annotations

from dataclasses import replace

from tracer.frame import Settings
from tracer.method import Method
from tracer.settings import RECORDS
from viewer.services.render_request import RenderRequest
from viewer.state.methods import NO_CULLING, with_base
from viewer.state.readings import records_fates, records_lights
from viewer.state.session import Session


def settings_for(session: Session, certificate_seconds: float, ready: bool, pixels: int) -> Settings:
    """What the user has set, with modes; verified, and with more recorded, where the view needs that and there is
    memory for it in a picture of so many `pixels`.  Until what makes certificates is `ready`, still being compiled,
    it is traced without: the picture is the same."""
    view, method = session.draw.view, session.settings.method
    lights = len(session.scene.lights) if session.scene is not None else 0
    if not ready and Method.parse(method).has_certificates:
        method = with_base(method, NO_CULLING)
    return replace(
        session.settings,
        method=method,
        verify=session.settings.verify or view.needs_verify,
        record_work=view.needs_work or session.counting,
        record_lights=records_lights(view, pixels, lights),
        record_fates=records_fates(view, pixels, lights),
        modes=not Method.parse(method).clusters,  # which would look at single lights for these alone
        certificate_seconds=certificate_seconds,
    )


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
