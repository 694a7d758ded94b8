"""The filmstrip of a zoom test as a figure: a row of recorded pictures for each zoom factor, the paper's Figure 4."""

from __future__ import annotations

from matplotlib.figure import Figure

from tracer.experiments import zoom
from viewer.output.figures import COLORS, SIZE, styled
from viewer.output.filmstrip import Filmstrip, Shot
from viewer.output.reports import happenings, zoom_title

COLUMNS = 8


@styled
def film_figure(film: Filmstrip, results: zoom.Results) -> Figure:
    """Up to COLUMNS pictures of each factor's way, the same steps for all: those where something happens first.

    Raises ValueError where no picture was kept."""
    approaches = [approach for approach in results.approaches if film.of(approach.factor)]
    numbers = chosen_steps(results, sorted({shot.number for a in approaches for shot in film.of(a.factor)}))
    if not numbers:
        raise ValueError("there is nothing to draw: no step")
    figure = Figure(figsize=(SIZE[0], 1.1 + 2.25 * len(approaches)), layout="constrained")
    panels = figure.subplots(len(approaches), len(numbers), squeeze=False)
    for row, approach in zip(panels, approaches):
        shots: dict[int, Shot] = {shot.number: shot for shot in film.of(approach.factor)}
        steps = {step.number: step for step in approach.steps}
        for panel, number in zip(row, numbers):
            panel.set_xticks([])
            panel.set_yticks([])
            panel.grid(False)
            if number not in shots or number not in steps:
                panel.axis("off")
                continue
            panel.imshow(shots[number].pixels(), interpolation="nearest")
            step = steps[number]
            panel.set_title(f"step {number}", fontsize=12.0)
            wrong = f"{step.wrong_of_primitive:,} wrong"
            panel.set_xlabel(f"{step.pixels:,} px\n{wrong}", fontsize=11.0, color=COLORS[1] if step.wrong else "black")
        row[0].set_ylabel(f"zoom factor {approach.factor:g}", fontsize=13.0)
    figure.suptitle(zoom_title(results), x=0.01, ha="left", fontsize=16.0)
    return figure


def chosen_steps(results: zoom.Results, kept: list[int]) -> list[int]:
    """Up to COLUMNS of the steps that pictures were kept of: first and last, where something happens, and between."""
    if len(kept) <= COLUMNS:
        return kept
    happened = sorted({step.number for approach in results.approaches for step in happenings(approach)} & set(kept))
    wanted = [kept[0], kept[-1], *happened]
    even = [kept[round(i * (len(kept) - 1) / (COLUMNS - 1))] for i in range(COLUMNS)]
    return sorted(list(dict.fromkeys([*wanted, *even]))[:COLUMNS])
