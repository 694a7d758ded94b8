"""Print every file of the packages with the first line of its docstring: `make files`."""

from __future__ import annotations

import ast
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def first_line(path: Path) -> str:
    """Return the first sentence, or line, of a module's docstring."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.partition("\n\n")[0].split()).partition(".  ")[0]


def main() -> None:
    for package in ("tracer", "viewer"):
        for path in sorted((ROOT / package).rglob("*.py")):
            if said := first_line(path):
                print(f"{path.relative_to(ROOT).as_posix():48} {said}")


if __name__ == "__main__":
    main()
