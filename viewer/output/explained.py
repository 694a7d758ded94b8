"""What the command `explain` says of a pixel: sentences as lines of text and as data for JSON, and its tree of rays."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tracer.reasons import Why
from tracer.scene.lights import named_light
from tracer.scene.model import Scene
from tracer.told_rays import VERDICTS, PathRay, RayTree, ShadowRays
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


def ray_data(tree: RayTree, scene: Scene) -> dict[str, Any]:
    """The pixel, how it was rendered, and its rays with all shadow rays that are due."""
    settings = tree.frame.settings
    return {
        "pixel": [tree.x, tree.y],
        "size": [tree.frame.width, tree.frame.height],
        "time": tree.frame.time,
        "method": settings.method,
        "accelerator": settings.accelerator,
        "color": _numbers(tree.color),
        "due": tree.due,
        "traced": tree.traced,
        "verdicts": {verdict.value: number for verdict, number in tree.counts.items()},
        "rays": [_ray(tree, ray, scene) for ray in tree.rays],
    }


def _ray(tree: RayTree, ray: PathRay, scene: Scene) -> dict[str, Any]:
    data: dict[str, Any] = {
        "ray": ray.number,
        "parent": ray.parent if ray.parent >= 0 else None,
        "kind": ray.kind.value,
        "bounce": ray.bounce,
        "origin": _numbers(ray.origin),
        "direction": _numbers(ray.direction),
        "weight": _numbers(ray.weight),
        "light": _numbers(ray.light),
        "traversal_steps": ray.steps,
        "intersection_tests": ray.tests,
        "hit": None,
        "shadow_rays": [],
    }
    if ray.shadows is not None:
        data["hit"] = {"t": ray.t, **_primitive(ray.primitive, scene), "point": _numbers(ray.point)}
        data["shadow_rays"] = [
            _shadow_ray(tree, ray.shadows, int(place), scene)
            for place in np.flatnonzero([VERDICTS[number].due for number in ray.shadows.verdict])
        ]
        data["facing_away"] = len(ray.shadows.light) - len(data["shadow_rays"])
    return data


def _shadow_ray(tree: RayTree, s: ShadowRays, place: int, scene: Scene) -> dict[str, Any]:
    light, verdict = int(s.light[place]), VERDICTS[s.verdict[place]]
    blocker = int(s.blocker[place])
    return {
        "light": light,
        "sample": place - s.of_light(light).start,
        "position": _numbers(tree.samples[place]),
        "verdict": verdict.value,
        "lit": bool(s.lit[place]),
        "wrong": bool(s.wrong[place]),
        "blocker": {**_primitive(blocker, scene), "t": float(s.blocked_at[place])} if blocker >= 0 else None,
        "met": int(s.met[place]) if s.met[place] >= 0 else None,
        "moving_objects_asked": bool(s.asked_moving[place]),
        "traversal_steps": int(s.steps[place]),
        "intersection_tests": int(s.tests[place]),
        "names": list(s.named.get(place, ())),
        "known": s.known.get(place),
        "told": s.told.get(place),
    }


def _primitive(number: int, scene: Scene) -> dict[str, Any]:
    return {"primitive": number, "object": scene.name_of(number)}


def _numbers(values: Any) -> list[float | None]:
    """Three numbers; JSON has none that are not finite."""
    return [float(x) if math.isfinite(x) else None for x in values]
