"""Images for surfaces: finding them, and reading them without trusting them.

Scenes name textures loosely (beside the file, beside the scene, in some folder of textures), and
an image file may be broken or claim a billion pixels.  Size is judged by the header before
anything is decoded; an image that is only too large to be useful is scaled down.  What a file is, its
first bytes say, whatever its name: only formats that are nothing but pixels are known.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from threading import Lock
from typing import Any, BinaryIO

import numpy as np
from PIL import Image, UnidentifiedImageError

from tracer.scene.files import SceneFiles, note, read_regular
from tracer.scene.limits import MOST_PIXELS
from tracer.scene.model import SceneError, Texture
from tracer.scene.pieces import TextureName

FORMATS = ("BMP", "GIF", "JPEG", "PNG", "PPM", "TGA", "TIFF", "WEBP")
"""Images that are read.  Pillow knows others that are programs, EPS above all, and runs Ghostscript for them."""

KEPT_PIXELS = 1 << 24
"""An image of more pixels is scaled down to this many."""

_TOO_LARGE = f"the image is too large; scale it down to {MOST_PIXELS >> 20} million pixels or fewer"

_lock = Lock()
_inside = 0  # threads that are within `only_known_images`
_open = Image.open

FOLDERS = ("texturefiles", "textures", "texture")


def find_texture(name: str, beside: Path, scene: Path, files: SceneFiles | None = None) -> Path | None:
    """The file that a texture's name means, or None.

    Looked for beside the file that names it, beside the scene, then in folders named like
    `TextureFiles` or `textures` (any case) next to either file or one level up.  It must lie in such a
    folder, or where `files` may be read (by default below the scene's folder).
    """
    files = files or SceneFiles(scene)
    folders = list(dict.fromkeys([beside.parent, scene.parent]))
    own = set(folders)
    for folder in [f for f in folders for f in (f, f.parent)]:
        try:
            folders += sorted(f for f in folder.iterdir() if f.name.lower() in FOLDERS and f.is_dir())
        except OSError:
            continue
    wanted = [name, name.replace("\\", "/")] if "\\" in name else [name]
    for folder, candidate in ((folder, folder / n) for n in wanted for folder in folders):
        try:
            # A folder of textures may lie beside the scene's, but no link may make one of another.
            there = folder not in own and _within(candidate, folder.parent.resolve() / folder.name)
            if candidate.is_file() and (there or files.holds(candidate)):
                return candidate
        except (OSError, ValueError, RuntimeError):  # a name too long, or with a zero byte, or a circle of links
            continue
    note(beside.parent / wanted[-1], None)
    return None


def _within(path: Path, folder: Path) -> bool:
    return path.resolve().is_relative_to(folder)


class TextureTable:
    """The textures of a scene, each file once.  One that cannot be had is a warning and number -1."""

    def __init__(self, scene: Path, files: SceneFiles) -> None:
        self.textures: list[Texture] = []
        self.warnings: list[str] = []
        self._scene, self._files = scene, files
        self._of_name: dict[tuple[str, Path], int] = {}
        self._of_file: dict[Path, int] = {}

    def number(self, named: TextureName, beside: Path) -> int:
        """Index into `textures` of what a name in the file `beside` means."""
        key = named.name, beside.parent
        if key not in self._of_name:
            path = find_texture(named.name, beside, self._scene, self._files)
            self._of_name[key] = -1 if path is None else self._load(path, named)
            if path is None:
                self._warn(named, f"texture {named.name!a} is not to be found")
        return self._of_name[key]

    def _load(self, path: Path, named: TextureName) -> int:
        resolved = path.resolve()
        if resolved not in self._of_file:
            try:
                self.textures.append(load_texture(path))
                check_pixels(self.textures)
                self._of_file[resolved] = len(self.textures) - 1
            except SceneError as error:
                self._of_file[resolved] = -1
                self._warn(named, f"texture {error}")
        return self._of_file[resolved]

    def _warn(self, named: TextureName, what: str) -> None:
        self.warnings.append(f"{named.place()}: {what}; the surface keeps its material colour")


def check_pixels(textures: list[Texture]) -> None:
    """Take the last texture off again and raise SceneError where they have too many pixels together."""
    if sum(t.pixels.size // 3 for t in textures) > MOST_PIXELS:
        textures.pop()
        raise SceneError(
            f"the scene's images together have more than {MOST_PIXELS >> 20} million pixels; use smaller ones"
        )


def load_texture(path: Path) -> Texture:
    """An image file as a texture; raises SceneError in one line where it cannot be one."""
    try:
        with open_image(BytesIO(read_regular(path))) as image:
            return texture_of(image, path.name)
    except (OSError, ValueError) as error:
        raise SceneError(f"{path}: {getattr(error, 'strerror', None) or error}; replace it") from None
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None


def open_image(source: BinaryIO, formats: Iterable[str] = FORMATS) -> Image.Image:
    """An image of which only the header was read; raises SceneError where that promises nothing good."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(source, formats=tuple(formats))
        check_size(image)
        return image
    except UnidentifiedImageError:
        raise SceneError("not an image that can be read; use PPM, PNG or JPEG") from None
    except SceneError:
        raise
    except Image.DecompressionBombError:
        raise SceneError(_TOO_LARGE) from None
    except Exception as error:  # Pillow's readers raise whatever they like on broken files
        raise SceneError(f"the image cannot be read ({_words(error)}); replace it") from None


def check_size(image: Image.Image) -> None:
    """Raise SceneError, by the header, for an image that is too large to be decoded."""
    if image.width * image.height > MOST_PIXELS:
        raise SceneError(f"{image.width} x {image.height}: {_TOO_LARGE}")


def texture_of(image: Image.Image, name: str) -> Texture:
    """A Pillow image as a texture; raises SceneError where it is empty, too large, or cannot be decoded."""
    check_size(image)
    width, height = image.size
    try:
        if width * height > KEPT_PIXELS:
            shrink = (KEPT_PIXELS / (width * height)) ** 0.5
            size = max(1, int(width * shrink)), max(1, int(height * shrink))
            image.draft("RGB", size)  # lets a JPEG be decoded at a fraction of its size
            image = image.convert("RGB").resize(size, Image.Resampling.BOX)
        return Texture(name, np.ascontiguousarray(np.asarray(image.convert("RGB"), np.uint8)))
    except Exception as error:  # as above; also where memory does not suffice
        raise SceneError(f"the image cannot be read ({_words(error)}); replace it") from None


def _words(error: Exception) -> str:
    return " ".join(str(error).split())[:120] or type(error).__name__


@contextmanager
def only_known_images() -> Iterator[None]:
    """Images within a file, which trimesh opens by itself, are of FORMATS: it would let Pillow try all that it knows.

    Several threads may read at once."""
    global _inside
    with _lock:
        _inside += 1
        Image.open = _known  # type: ignore[assignment]
    try:
        yield
    finally:
        with _lock:
            _inside -= 1
            if not _inside:
                Image.open = _open


def _known(source: Any, mode: Any = "r", formats: Any = FORMATS) -> Image.Image:
    return _open(source, mode, formats)
