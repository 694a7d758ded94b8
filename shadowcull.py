"""The command `shadowcull`, and `python -m shadowcull`: starts the program, if the packages it is made of are its own.

`tracer` and `viewer` are names that other projects have, too.  Where such a project is installed in the same
environment, or comes first on the path, one of the two would be imported in place of the other, and fail anywhere.
"""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

OWN = {"tracer": "load_scene", "viewer": "viewer.__main__"}
"""The packages, and what stands in the first file of each and of no other's."""
ALONE = "install shadowcull in an environment of its own, as by 'pipx install shadowcull'"


def main() -> int:
    """Run the command line of this process; returns the exit code."""
    for name, mark in OWN.items():
        wrong = foreign(name, mark)
        if wrong:
            print(f"shadowcull: error: {wrong}", file=sys.stderr)
            return 1
    from viewer.__main__ import main

    return main()


def foreign(name: str, mark: str) -> str:
    """What is wrong with a package, in one line; nothing where it has its mark and is the one beside this file, or
    where none is beside it: then it is installed from its sources, which stay where they are."""
    here = Path(__file__).resolve().parent / name
    found = find_spec(name)
    origin = Path(found.origin).resolve() if found is not None and found.origin is not None else None
    if origin is None:
        return f"there is no package {name!r} in {here}, as another project's was removed; install shadowcull again"
    try:
        own = (origin.parent == here or not (here / "__init__.py").exists()) and mark in origin.read_text(
            encoding="utf-8", errors="replace"
        )
    except OSError as error:
        return f"{origin}: cannot be read: {error.strerror or error}"
    return "" if own else f"{origin} is another project's package {name!r}; {ALONE}"


if __name__ == "__main__":
    sys.exit(main())
