"""How meshes are read, as options of the command line."""

from __future__ import annotations

import argparse
from argparse import Namespace
from collections.abc import Sequence
from typing import TYPE_CHECKING

from viewer.cli.argument_types import number

if TYPE_CHECKING:  # importing the tracer takes a while, for which --help need not wait
    from tracer.scene.mesh_options import MeshOptions

_UPS = ("x", "y", "z", "-x", "-y", "-z")


def add_mesh_options(parser: argparse.ArgumentParser) -> None:
    """`--up`, `--crease` and `--no-studio`; without them a model that comes alone is set in a studio."""
    group = parser.add_argument_group("meshes (OBJ, PLY, STL, glTF, GLB)")
    add = group.add_argument
    help_ = "the axis that points up in a model without camera and lights: x, y, z, -x, -y or -z (default: a guess)"
    add("--up", choices=_UPS, metavar="AXIS", help=help_)
    help_ = (
        "where the file has no normals, round edges that are bent by up to DEG degrees; 0: none (default: 40 for a "
        "model without camera and lights, else 0)"
    )
    add("--crease", type=number(0.0, 180.0), metavar="DEG", help=help_)
    help_ = "no floor, lamps and upright view for a model without camera and lights, and no rounded edges"
    add("--no-studio", action="store_true", help=help_)


def mesh_options(options: Namespace) -> MeshOptions:
    """What these options ask for."""
    from tracer.scene.mesh_options import MeshOptions

    return MeshOptions(not options.no_studio, options.up, options.crease)


def as_arguments(options: MeshOptions) -> list[str]:
    """The options that ask for this."""
    up = [f"--up={options.up}"] if options.up is not None else []
    crease = [f"--crease={options.crease:g}"] if options.crease is not None else []
    return [*up, *crease, *([] if options.studio else ["--no-studio"])]


def joined(arguments: Sequence[str]) -> list[str]:
    """The arguments with `--up -z` as one: a word that begins with a dash would be taken for an option."""
    found: list[str] = []
    for argument in arguments:
        if found and found[-1] == "--up" and argument in _UPS:
            found[-1] = f"--up={argument}"
        else:
            found.append(argument)
    return found
