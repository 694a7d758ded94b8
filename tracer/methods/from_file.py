"""A method of one's own, from a file: what it defines is registered, and what is wrong with it is said in one line."""

from __future__ import annotations

import re
import sys
import traceback
from importlib.util import module_from_spec, spec_from_file_location
from inspect import getdoc
from pathlib import Path
from typing import Any

from numba.core.errors import NumbaError

from tracer.method import Kind, additions, bases, register
from tracer.methods.interface import ShadowMethod


def load_method(path: Path) -> str:
    """Run a file that defines a method, and return the name by which that can be used from now on.

    It is the method that the file registers (`tracer.method.register`).  Where it registers none, it is its class: by
    the name of the file, and as one that claims to be exact.  Raises OSError and ValueError, each in one line."""
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    before, folder = _registered(), str(path.resolve().parent)
    spec: Any = spec_from_file_location(f"method_in_{path.stem}", path)
    module = module_from_spec(spec)
    sys.modules[spec.name] = module  # where its dataclasses look for themselves
    sys.path.insert(0, folder)  # for what lies beside it
    try:
        spec.loader.exec_module(module)
        new = [name for name in _registered() if name not in before] or [_register_class(path.stem, module)]
    except (Exception, SystemExit) as error:
        raise ValueError(f"{path}: {said_of(error, path)}") from error
    finally:
        sys.path.remove(folder)
    if len(new) > 1:
        raise ValueError(f"{path}: registers several methods ({', '.join(new)}); leave one")
    is_base = new[0] in [kind.name for kind in bases(measures=True)]
    return new[0] if is_base else f"none+{new[0]}"


def _registered() -> list[str]:
    return [kind.name for kind in (*bases(measures=True), *additions(measures=True))]


def _register_class(name: str, module: Any) -> str:
    """Register the one class of a file that is a method; raises ValueError where there is none, or another of its
    name."""
    classes = [value for value in vars(module).values() if isinstance(value, type) and issubclass(value, ShadowMethod)]
    own = [one for one in classes if one.__module__ == module.__name__]
    if len(own) != 1:
        named = f"several methods ({', '.join(one.__name__ for one in own)}): register one" if own else "no method"
        raise ValueError(f"it defines {named}; a method is a subclass of tracer.methods.interface.ShadowMethod")
    return register(Kind(name, (getdoc(own[0]) or name).splitlines()[0], own[0])).name


def said_of(error: BaseException, path: Path) -> str:
    """An error of a method in one line, with the line of its file that it comes from, as far as that is known."""
    text = str(error)
    lines = [int(line) for name, line in re.findall(r'File "(.+?)", line (\d+)', text) if Path(name).name == path.name]
    frames = traceback.extract_tb(error.__traceback__)
    lines += [frame.lineno for frame in frames if Path(frame.filename) == path and frame.lineno]
    if isinstance(error, SyntaxError):
        lines, text = [error.lineno or 1], error.msg
    if isinstance(error, NumbaError):  # the first line says at which of numba's steps
        said = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("Failed in")]
        what = f"a kernel does not compile: {said[0] if said else type(error).__name__}"
    elif isinstance(error, ValueError) and not lines:
        what = text
    else:
        what = f"{type(error).__name__}: {' '.join(text.split())}".rstrip(": ")
    return f"line {lines[-1]}: {what}" if lines else what
