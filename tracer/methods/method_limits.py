"""What of a scene a method has nothing to say of, in a sentence."""

from __future__ import annotations

from tracer.method import MANY, Kind, Method
from tracer.scene.lights import Light, as_lamps


def lamps_in(lights: tuple[Light, ...], radius: float | None, samples: int | None) -> tuple[int, int]:
    """How many of a scene's lights are lamps of several samples, with such settings, and how many samples all lights
    have together."""
    each = [light.samples if light.kind != "point" else 1 for light in as_lamps(lights, radius, samples)]
    return sum(count > 1 for count in each), sum(each)


def lights_in_words(lights: int, samples: int) -> str:
    """So many lights, and how many samples they have together where any is a lamp of several: 4,096 samples of 256
    lights."""
    said = f"{lights:,} light{'s' * (lights != 1)}"
    return said if samples == lights else f"{samples:,} samples of {said}"


def too_few(method: Method, lights: int, samples: int) -> str:
    """Why clusters gain nothing where lights have so few samples together; nothing where they may."""
    if not method.clusters or samples >= MANY:
        return ""
    what = "lights" if samples == lights else "light samples"
    there = "is" if samples == 1 else "are"
    return f"{method.kind.title} is for {MANY} {what} or more, and there {there} {samples} here"


def remark(method: Method, lights: int, lamps: int) -> str:
    """Which lights a method leaves to tracing, where there are so many `lights`, and `lamps` of them have several
    samples; nothing where it leaves none."""
    return " ".join(filter(None, (_of(kind, lights, lamps, len(method.kinds) == 1) for kind in method.kinds)))


def _of(kind: Kind, lights: int, lamps: int, alone: bool) -> str:
    beyond = lights > kind.answers
    left = lamps > 0 and not kind.lamps
    if kind.in_part and (beyond or left):
        which = " and ".join(
            filter(None, ("lamps of several samples" * left, f"lights after the first {kind.answers}" * beyond))
        )
        return f"Of {which}, {kind.title} only knows which ones a single triangle hides from a cell."
    if left and lamps == lights:
        every = "every shadow ray is traced" if alone else "it answers no ray"
        return f"All lights are lamps of several samples, of which {kind.title} knows nothing: {every}."
    if left:
        nor = f", nor of lights after the first {kind.answers}" if beyond else ""
        traced = "rays to them are traced" if alone else "it leaves them alone"
        return f"Of lamps of several samples, {lamps:,} here, {kind.title} knows nothing{nor}; {traced}."
    if beyond:
        traced = "rays to the others are traced" if alone else "it leaves the others alone"
        return f"Of {lights:,} lights, {kind.title} answers for the first {kind.answers}; {traced}."
    return ""


def worth(kind: Kind, lights: int, samples: int | None = None) -> str:
    """Why a method has nothing to say of a scene with so many lights and samples of them (`Kind.fits`); nothing where
    it has."""
    least, most = kind.lights
    if (lights if samples is None else samples) < least:
        return f"It is for {least} {'lights' if samples in (None, lights) else 'light samples'} or more."
    return f"It is for {most} lights or fewer." if lights > most else ""
