"""Writes the embedded scenes, their textures and the icon: `python assets/make_scenes.py [folder]`.

All of it is computed from formulas and fixed seeds, so a second run writes the same bytes; the
tests hold the committed files against that.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
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


def make() -> dict[str, bytes]:
    """Every generated file by its path under `assets`."""
    files = {"scenes/default.aff": room.text("study").encode()}
    for name, model in room.study().files().items():
        files[f"scenes/study/{name}.aff"] = model.text().encode()
    files["scenes/study/tracks.aff"] = room.tracks().encode()
    for name, root, model in (
        ("office", office.text("office"), office.office()),
        ("courtyard", courtyard.text("courtyard"), courtyard.courtyard()),
    ):
        files[f"scenes/{name}.aff"] = root.encode()
        files |= {f"scenes/{name}/{part}.aff": held.text().encode() for part, held in model.files().items()}
    files["scenes/figure3.aff"] = figures.figure3().encode()
    files["scenes/figure4.aff"] = figures.figure4().encode()
    for name, draw in TEXTURES.items():
        files[f"scenes/textures/{name}.ppm"] = ppm(draw())
    files["icon.png"] = png(icon.icon())
    return files


def main() -> None:
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for path, data in make().items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_bytes(data)
        print(f"{len(data):9,d}  {path}")


if __name__ == "__main__":
    main()
