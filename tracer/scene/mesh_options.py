"""What a reader of meshes may choose where files leave it open: which way is up, which edges are sharp, and whether a
model that comes alone is set in a studio."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

UPS = ("x", "y", "z", "-x", "-y", "-z")
"""Axes that may point up."""
CREASE = 40.0
"""Degrees: an edge that is bent by less is rounded in a studio."""
MOST_CREASE = 180.0


@dataclass(frozen=True)
class MeshOptions:
    """How meshes are read. AFF and NFF files say all of it themselves.

    Parameters
    ----------
    studio : bool
        Whether a model whose file has neither a camera nor lights is set on a floor, before a camera, among lamps.
    up : str or None
        Which axis points up there, one of `UPS`. None: it is guessed.
    crease : float or None
        The angle in degrees, 0 to 180, up to which edges are rounded where the file has no normals; 0 leaves all
        sharp. None: 40 in a studio, and 0 elsewhere and for glTF, which asks for sharp edges.
    """

    studio: bool = False
    up: str | None = None
    crease: float | None = None

    def __post_init__(self) -> None:
        if self.up is not None and self.up not in UPS:
            raise ValueError(f"the axis that points up is one of {', '.join(UPS)}, not {self.up}")
        if self.crease is not None and not (math.isfinite(self.crease) and 0.0 <= self.crease <= MOST_CREASE):
            raise ValueError(f"a crease angle lies between 0 and {MOST_CREASE:g} degrees, not {self.crease:g}")

    def of_file(self, path: Path) -> MeshOptions:
        """These, where the file is a mesh; the usual ones where it says all of it itself."""
        return AS_IN_FILE if path.suffix.lower() in (".aff", ".nff") else self


AS_IN_FILE = MeshOptions()
"""Nothing is added."""
IN_STUDIO = MeshOptions(studio=True)
"""As the commands and the window read meshes."""
