"""A method in a file of Python: what it defines is registered, and what is wrong with it is said in one line."""

from __future__ import annotations

import ast
import re
import sys
import traceback
from importlib.util import module_from_spec, spec_from_file_location
from inspect import getdoc
from pathlib import Path
from types import ModuleType
from typing import Any

from numba.core.errors import NumbaError

from tracer.method import Kind, additions, bases, register
from tracer.methods.interface import ShadowMethod
from viewer.util.messages import one_line


def load_method(path: Path) -> str:
    """Run a file that defines a method, and return the name by which that can be used from now on.

    It is the method that the file registers (`tracer.method.register`).  Where it registers none, it is its class: by
    the name of the file, and as one that claims to be exact.  Raises OSError and ValueError, each in one line."""
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    before, folder = _registered(), str(path.resolve().parent)
    spec: Any = spec_from_file_location(f"method_in_{path.stem}", path)
    module = sys.modules[spec.name] = module_from_spec(spec)  # where its dataclasses look for themselves
    sys.path.insert(0, folder)  # for what lies beside it
    try:
        spec.loader.exec_module(module)
        new = [name for name in _registered() if name not in before] or [_register_class(path.stem, module)]
        if len(new) > 1:
            raise ValueError(f"registers several methods: {', '.join(new)}")
    except (Exception, SystemExit) as error:
        raise ValueError(said_of(error, path)) from error
    finally:
        sys.path.remove(folder)
    return new[0] if new[0] in [kind.name for kind in bases(measures=True)] else f"none+{new[0]}"


def _registered() -> list[str]:
    return [kind.name for kind in (*bases(measures=True), *additions(measures=True))]


def _register_class(name: str, module: ModuleType) -> str:
    """Register the one class of a file that is a method; raises ValueError where that cannot be."""
    own = [value for value in vars(module).values() if getattr(value, "__module__", "") == module.__name__]
    methods = [value for value in own if isinstance(value, type) and issubclass(value, ShadowMethod)]
    if len(methods) != 1:
        named = ", ".join(one.__name__ for one in methods)
        raise ValueError(f"one subclass of tracer.methods.interface.ShadowMethod is needed, not {named or 'none'}")
    return register(Kind(name, (getdoc(methods[0]) or name).splitlines()[0], methods[0])).name


def said_of(error: BaseException, path: Path) -> str:
    """An error of a method in one line, with the line of its file that it comes from, as far as that is known."""
    told = "".join(traceback.format_exception(error))
    lines = re.findall(rf'{re.escape(path.name)}", line (\d+)', told)
    said = f"SyntaxError: {error.msg}" if isinstance(error, SyntaxError) else one_line(error)
    if isinstance(error, NumbaError):  # which begins with the step that failed
        reasons = [line for line in str(error).splitlines() if line.strip() and not line.startswith("Failed in")]
        said = f"a kernel does not compile: {' '.join(reasons[:1])}"
        if unknown := re.search(r"NameError: .*'(\w+)'", said):  # of which numba does not say where it stands
            names = (one for one in ast.walk(ast.parse(path.read_bytes())) if isinstance(one, ast.Name))
            lines = lines or [one.lineno for one in names if one.id == unknown[1]]
    return f"{path}: {f'line {lines[-1]}: ' if lines else ''}{said}"
