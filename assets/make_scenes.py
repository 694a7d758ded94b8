"""Writes the embedded scenes, their textures and the icon: `python assets/make_scenes.py [folder]`.

All of it is computed from formulas and fixed seeds, so a second run writes the same bytes; the
tests hold the committed files against that.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from generate import courtyard, figures, icon, office, pictures, room, textures
from generate.images import png, ppm
from generate.mesh import Array

TEXTURES: dict[str, Callable[[], Array]] = {
    "parquet": textures.parquet,
    "wood": textures.wood,
    "wallpaper": textures.wallpaper,
    "marble": textures.marble,
    "brick": textures.brick,
    "cloth": textures.cloth,
    "rug": textures.rug,
    "spines": textures.spines,
    "garden": pictures.garden,
    "seascape": pictures.seascape,
    "partition": pictures.partition,
    "eclipse": pictures.eclipse,
    "globe": pictures.globe,
    "clock_face": pictures.clock_face,
}


def study() -> Iterator[tuple[str, str]]:
    yield "scenes/default.aff", room.text("study")
    yield "scenes/study/tracks.aff", room.tracks()
    for name, model in room.study().files().items():
        yield f"scenes/study/{name}.aff", model.text()


def many_lights() -> Iterator[tuple[str, str]]:
    yield "scenes/office.aff", office.text("office")
    yield "scenes/courtyard.aff", courtyard.text("courtyard")
    for scene, model in (("office", office.office()), ("courtyard", courtyard.courtyard())):
        for name, part in model.files().items():
            yield f"scenes/{scene}/{name}.aff", part.text()


def papers_figures() -> Iterator[tuple[str, str]]:
    yield "scenes/figure3.aff", figures.figure3()
    yield "scenes/figure4.aff", figures.figure4()


def images() -> Iterator[tuple[str, bytes]]:
    for name, draw in TEXTURES.items():
        yield f"scenes/textures/{name}.ppm", ppm(draw())
    yield "icon.png", png(icon.icon())


PARTS = (papers_figures, many_lights, images, study)


def make(parts: Iterable[Callable[[], Iterator[tuple[str, str | bytes]]]] = PARTS) -> dict[str, bytes]:
    """Every generated file of some parts, by its path under `assets`."""
    files = (file for part in parts for file in part())
    return {path: data if isinstance(data, bytes) else data.encode() for path, data in files}


def main() -> None:
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for path, data in make().items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_bytes(data)
        print(f"{len(data):9,d}  {path}")


if __name__ == "__main__":
    main()
