"""A frame as notebooks show it: its picture, and a small table of what it cost."""

from __future__ import annotations

import base64
from html import escape
from io import BytesIO

import numpy as np
from numpy.typing import NDArray

from tracer.statistics import FrameStatistics


def pixels_of(color: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(h, w, 3) uint8: linear colours (h, w, 3) as a screen shows them."""
    return np.round(np.clip(color, 0.0, 1.0) * np.float32(255.0)).astype(np.uint8)


def png_of(color: NDArray[np.float32]) -> bytes:
    """The file of the picture of these colours, (h, w, 3)."""
    from PIL import Image

    file = BytesIO()
    Image.fromarray(pixels_of(color)).save(file, "PNG")
    return file.getvalue()


def html_of(color: NDArray[np.float32], title: str, statistics: FrameStatistics) -> str:
    """The picture, (h, w, 3), beside its counters."""
    height, width = color.shape[:2]
    image = base64.b64encode(png_of(color)).decode()
    rays, wrong = statistics.shadow, statistics.wrong
    due = max(rays.due, 1)
    lines = [
        ("shadow rays due", f"{rays.due:,}"),
        ("saved", f"{rays.saved:,} ({rays.saved / due:.1%})"),
        ("culled", f"{rays.culled:,} ({rays.culled / due:.1%})"),
        ("dynamic only", f"{rays.dynamic_only:,} ({rays.dynamic_only / due:.1%})"),
        ("traced", f"{rays.traced:,} ({rays.traced / due:.1%})"),
        ("traversal steps", f"{rays.traversal_steps + statistics.certificate_steps:,}"),
        ("intersection tests", f"{rays.intersection_tests + statistics.certificate_tests:,}"),
        ("frame", f"{1000.0 * statistics.seconds:.1f} ms"),
    ]
    if wrong is not None:
        lines.insert(5, ("wrong answers", f"{wrong.answers:,}"))
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td style='text-align:right'>{value}</td></tr>" for name, value in lines
    )
    return (
        "<div style='display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start'>"
        f"<img width='{width}' height='{height}' alt='{escape(title)}' src='data:image/png;base64,{image}'>"
        f"<table><caption style='text-align:left'>{escape(title)}</caption>{rows}</table></div>"
    )
