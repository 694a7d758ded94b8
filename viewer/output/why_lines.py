"""The sentences that explain a pixel (`tracer.why_in_words`), as lines of text and as plain data."""

from __future__ import annotations

from typing import Any

from tracer.reasons import Why
from tracer.scene.lights import named_light
from tracer.scene.model import Scene
from tracer.why_in_words import Words, plain

MOST_LIGHTS = 3  # that are named before a sentence that they share; of more, the number is said


def why_lines(found: Why, scene: Scene, light: int | None = None) -> list[str]:
    """Return a line for each sentence: why the rays to the lights, or to one of them, were culled or traced, with the
    lights that share it; how the primitive stands; and its comparison with the two reference pixels."""
    if found.primitive < 0:
        return ["Nothing is seen here but the background."]
    words, lines = Words(scene, found), []
    shared: dict[str, list[int]] = {}
    for one in found.reasons:
        if light is None or one.light == light:
            text = " ".join(filter(None, (plain(words.reason(one)), plain(words.answer(one)))))
            shared.setdefault(text, []).append(one.light)
    for text, lights in shared.items():
        named = ", ".join(named_light(scene.lights, number) for number in lights[:MOST_LIGHTS])
        more = f" and {len(lights) - MOST_LIGHTS} more" if len(lights) > MOST_LIGHTS else ""
        lines.append(f"{named}{more}: {text}")
    if found.coverage is not None:
        lines.append(plain(words.coverage(found.coverage)))
    lines += [plain(words.reference(one)) for one in found.references]
    return lines


def why_data(found: Why, scene: Scene) -> list[dict[str, Any]]:
    """Return the reasons as data for JSON, each with its sentence."""
    words = Words(scene, found)
    return [
        {
            "light": one.light,
            "rule": one.rule.name,
            "section": one.rule.section or None,
            "fate": one.fate.name,
            "sentence": plain(words.reason(one)),
            "answer": plain(words.answer(one)) or None,
        }
        for one in found.reasons
    ]
