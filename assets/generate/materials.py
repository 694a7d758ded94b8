"""The palette.  Colours are display-referred; matte things have no specular part, so that they do not mirror."""

from __future__ import annotations

from generate.aff import Colour, Material

AMBIENT = 0.30
GLOBAL_AMBIENT = 1.3  # the scene's `am`, which scales every ambient part


def matte(name: str, colour: Colour, ambient: float = AMBIENT) -> Material:
    r, g, b = colour
    return Material(name, colour, (ambient * r, ambient * g, ambient * b))


def glossy(name: str, colour: Colour, specular: float, shine: float, ambient: float = AMBIENT) -> Material:
    """A highlight and a mirror image of strength `specular`; the Phong exponent is 4 x shine."""
    r, g, b = colour
    return Material(name, colour, (ambient * r, ambient * g, ambient * b), (specular,) * 3, shine)


def metal(name: str, colour: Colour, specular: Colour, shine: float = 15.0) -> Material:
    r, g, b = colour
    return Material(name, colour, (0.5 * r, 0.5 * g, 0.5 * b), specular, shine)


def textured(name: str, texture: str, tint: Colour = (1, 1, 1), specular: float = 0.0, shine: float = 10.0) -> Material:
    r, g, b = tint
    return Material(name, tint, (AMBIENT * r, AMBIENT * g, AMBIENT * b), (specular,) * 3, shine, texture=texture)


def glowing(name: str, colour: Colour, texture: str | None = None) -> Material:
    """Shines by its ambient part alone: shadows and lights do not touch it."""
    r, g, b = (c / GLOBAL_AMBIENT for c in colour)
    return Material(name, (0.0, 0.0, 0.0), (r, g, b), texture=texture)


PARQUET = textured("parquet", "parquet", (0.95, 0.95, 0.95), 0.06, 12)
WALLPAPER = textured("wallpaper", "wallpaper")
PAINT = matte("painted panels", (0.76, 0.73, 0.66))
TRIM = matte("painted trim", (0.84, 0.81, 0.74))
CEILING = matte("ceiling", (0.88, 0.86, 0.81))
BEAM = textured("beam", "wood", (0.85, 0.75, 0.65))
BRICK = textured("brick", "brick", (0.95, 0.95, 0.95))
MARBLE = textured("marble", "marble", (0.95, 0.95, 0.95), 0.06, 25)
WALNUT = textured("walnut", "wood", (1.0, 1.0, 1.0))
OAK = textured("light oak", "wood", (1.45, 1.50, 1.45))
MAHOGANY = textured("mahogany", "wood", (1.05, 0.78, 0.70), 0.05, 20)
CLOTH = textured("upholstery", "cloth")
RUG = textured("rug", "rug")
SPINES = textured("book spines", "spines", (1.1, 1.1, 1.1))
PAGES = matte("pages", (0.88, 0.83, 0.70))
CURTAIN = matte("curtain", (0.66, 0.24, 0.17), 0.34)
GARDEN = glowing("garden", (1.0, 1.0, 1.0), "garden")
SEASCAPE = textured("seascape", "seascape", (1.2, 1.2, 1.2))
PARTITION = textured("partition", "partition")
ECLIPSE = textured("eclipse", "eclipse")
GLOBE = textured("globe", "globe", (1.0, 1.0, 1.0), 0.05, 25)
CLOCK_FACE = textured("clock face", "clock_face", (1.0, 1.0, 1.0), 0.02, 20)

MIRROR = Material("mirror", (0.03, 0.03, 0.03), (0.02, 0.02, 0.02), (0.86, 0.88, 0.87), 60.0)
GLASS = Material("glass", (0.03, 0.04, 0.04), (0.02, 0.025, 0.025), (0.10, 0.10, 0.10), 60.0, 0.88, 1.5)
CRYSTAL = Material("crystal", (0.02, 0.02, 0.03), (0.01, 0.01, 0.02), (0.12, 0.12, 0.12), 80.0, 0.90, 1.5)
WINE = Material("wine", (0.25, 0.02, 0.04), (0.12, 0.01, 0.02), (0.08, 0.06, 0.06), 50.0, 0.35, 1.34)
BRASS = metal("brass", (0.52, 0.38, 0.14), (0.36, 0.27, 0.11), 18)
GOLD = metal("gilding", (0.60, 0.44, 0.16), (0.22, 0.17, 0.07), 12)
STEEL = metal("steel", (0.30, 0.31, 0.33), (0.42, 0.43, 0.45), 25)
IRON = glossy("iron", (0.10, 0.10, 0.11), 0.06, 8)
CHROME = metal("chrome", (0.10, 0.10, 0.11), (0.72, 0.73, 0.75), 50)

IVORY = glossy("boxwood", (0.84, 0.72, 0.50), 0.06, 25)
EBONY = glossy("ebony", (0.15, 0.095, 0.07), 0.05, 25)
LEATHER = matte("green leather", (0.10, 0.24, 0.16))
SHADE = glowing("lamp shade", (0.98, 0.84, 0.58))
BULB = glowing("bulb", (1.0, 0.96, 0.84))
FLAME = glowing("flame", (1.0, 0.62, 0.14))
EMBER = glowing("ember", (0.92, 0.28, 0.06))
WAX = matte("wax", (0.92, 0.88, 0.76), 0.4)
SOOT = matte("soot", (0.22, 0.15, 0.11))
BARK = matte("log", (0.34, 0.22, 0.13))
TERRACOTTA = matte("terracotta", (0.66, 0.34, 0.20))
SOIL = matte("soil", (0.17, 0.11, 0.07))
LEAF = matte("leaf", (0.17, 0.42, 0.14))
LEAF_PALE = matte("young leaf", (0.38, 0.56, 0.20))
STEM = matte("stem", (0.30, 0.27, 0.12))
APPLE = glossy("apple", (0.70, 0.12, 0.10), 0.06, 25)
ORANGE = glossy("orange", (0.90, 0.48, 0.08), 0.03, 12)
PEAR = glossy("pear", (0.66, 0.68, 0.20), 0.04, 15)
CHINA = glossy("china", (0.86, 0.87, 0.90), 0.06, 40)
BLUE_CHINA = glossy("blue china", (0.13, 0.24, 0.55), 0.09, 40)
PAPER = matte("paper", (0.92, 0.90, 0.84))
RED_PAINT = glossy("red enamel", (0.76, 0.10, 0.08), 0.08, 30)
BLUE_PAINT = glossy("blue enamel", (0.10, 0.26, 0.62), 0.08, 30)
GREEN_PAINT = glossy("green enamel", (0.08, 0.40, 0.20), 0.08, 30)
YELLOW_PAINT = glossy("yellow enamel", (0.92, 0.70, 0.12), 0.06, 30)
BLACK_PAINT = glossy("black enamel", (0.08, 0.08, 0.09), 0.10, 30)
