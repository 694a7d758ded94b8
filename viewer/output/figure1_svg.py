"""Figure 1 as a picture for slides and pages, in SVG: text stays text, and what is said of a part is its tooltip."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.sax.saxutils import escape

from tracer.frame import Frame
from tracer.scene.model import Scene
from viewer.output.figure1 import Figure, figure_of
from viewer.output.figure1_layout import Arrow, Box, Drawing, Tone, Words, lay_out
from viewer.output.overlays import font
from viewer.state.palette import Color
from viewer.state.session import Session
from viewer.util.files import write_whole

WIDTH, HEIGHT = 1280.0, 720.0
"""Of the picture in pixels; it is as high as it must be."""
_MARGIN = 24.0
_LETTERS, _LINE = 15, 18.0  # how high letters and lines are
_STRONG = 1.12  # how much wider bold letters are
_FONTS = "'DejaVu Sans', Verdana, Arial, Helvetica, sans-serif"  # the widest first, as texts are measured by it
_COLORS = {Tone.PLAIN: "#1c2026", Tone.STRONG: "#1c2026", Tone.QUIET: "#5a6270"}
_BOX, _EDGE, _ARROW, _TIME, _OUTLINE = "#f4f5f7", "#aab1bc", "#5a6270", "#1f6fbf", "#5a6270"
_HEAD = 4.5


def write(path: Path, frame: Frame, scene: Scene) -> None:
    """Write the figure of a frame; raises OSError in one line."""
    text = svg(figure_of(frame, f"{scene.path.stem}, frame {Session(scene).frame_at(frame.time)}"))
    write_whole(path, lambda file: file.write(text.encode()))


def svg(figure: Figure) -> str:
    """The text of the SVG."""
    inner = lay_out(figure, font(_LETTERS).getlength, _LINE, WIDTH - 2 * _MARGIN, HEIGHT - 2 * _MARGIN, _STRONG)
    return "\n".join(_lines(figure, inner)) + "\n"


def _lines(figure: Figure, drawing: Drawing) -> Iterator[str]:
    height = drawing.height + 2 * _MARGIN
    size = f'width="{WIDTH:g}" height="{height:.0f}" viewBox="0 0 {WIDTH:g} {height:.0f}"'
    yield f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="{_FONTS}" font-size="{_LETTERS}">'
    yield f"<title>{escape(figure.title)}</title>"
    yield '<rect width="100%" height="100%" fill="#ffffff"/>'
    yield f'<g transform="translate({_MARGIN:g} {_MARGIN:g})">'
    for box in drawing.boxes:
        yield _rectangle(box, _BOX, f' stroke="{_EDGE}" rx="4"')
    for box in drawing.times:
        yield _rectangle(box, _TIME)
    for box in drawing.bars:
        color = _hex(box.color) if box.color else _BOX
        edge = f' stroke="{color if box.hollow else _OUTLINE}" stroke-width="{2 if box.hollow else 0.5}"'
        yield _rectangle(box, "none" if box.hollow else color, edge)
    for arrow in drawing.arrows:
        yield from _arrow(arrow)
    for words in drawing.words:
        yield _text(words)
    for area in drawing.areas:
        shape = _rectangle(Box(area.x, area.y, area.width, area.height), "none", ' stroke="none" pointer-events="all"')
        yield f"{shape.removesuffix('/>')}><title>{escape(area.tip)}</title></rect>"
    yield "</g>"
    yield "</svg>"


def _rectangle(box: Box, fill: str, more: str = "") -> str:
    place = f'x="{box.x:.1f}" y="{box.y:.1f}" width="{box.width:.1f}" height="{box.height:.1f}"'
    return f'<rect {place} fill="{fill}"{more}/>'


def _arrow(arrow: Arrow) -> Iterator[str]:
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in arrow.points)
    yield f'<polyline points="{points}" fill="none" stroke="{_ARROW}" stroke-width="1.5"/>'
    if arrow.head:
        corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in arrow.head_of(_HEAD))
        yield f'<polygon points="{corners}" fill="{_ARROW}"/>'


def _text(words: Words) -> str:
    weight = ' font-weight="600"' if words.tone is Tone.STRONG else ""
    place = f'x="{words.x:.1f}" y="{words.y + 0.8 * _LINE:.1f}"'
    anchor = ' text-anchor="end"' if words.right else ""
    return f'<text {place} fill="{_COLORS[words.tone]}"{weight}{anchor}>{escape(words.text)}</text>'


def _hex(color: Color) -> str:
    return "#" + "".join(f"{round(255.0 * channel):02x}" for channel in color)
