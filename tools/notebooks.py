"""Runs the notebooks of the documentation and keeps what their cells print and show.

    python tools/notebooks.py [NOTEBOOK...]    run these, or all, and write their outputs into them
    python tools/notebooks.py --check          run all, and say whether they print and show what is kept

The cells are run in one namespace each notebook, as Jupyter does, which need not be installed: the value of a cell's
last line is shown, figures of matplotlib are shown at the end of their cell, and `%%writefile` writes a module.
"""

from __future__ import annotations

import ast
import base64
import io
import json
import os
import re
import sys
import tempfile
from contextlib import chdir, redirect_stdout
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs" / "notebooks"
WRITE_FILE, CHECK = "%%writefile ", "--check"


def code_cells(notebook: dict[str, Any]) -> list[dict[str, Any]]:
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def run(notebook: dict[str, Any]) -> None:
    """Run all cells in a folder of their own, and replace their outputs; raises what a cell raises."""
    import matplotlib

    matplotlib.use("agg")
    names: dict[str, Any] = {"__name__": "__main__"}
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        sys.path.insert(0, folder)
        try:
            for number, cell in enumerate(code_cells(notebook), start=1):
                cell["execution_count"] = number
                cell["outputs"] = _run_cell("".join(cell["source"]), names, number)
        finally:
            sys.path.remove(folder)


def _run_cell(source: str, names: dict[str, Any], number: int) -> list[dict[str, Any]]:
    """What a cell prints and shows, as a notebook keeps it."""
    if source.startswith(WRITE_FILE):
        name, _, text = source[len(WRITE_FILE) :].partition("\n")
        Path(name.strip()).write_text(text)
        return []
    tree = ast.parse(source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed = io.StringIO()
    with redirect_stdout(printed):
        exec(compile(tree, f"<cell {number}>", "exec"), names)
        value = (
            eval(compile(ast.Expression(last.value), f"<cell {number}>", "eval"), names) if last is not None else None
        )
    outputs = []
    if printed.getvalue():
        outputs.append({"output_type": "stream", "name": "stdout", "text": printed.getvalue().splitlines(True)})
    if value is not None and not _is_plot(value):
        outputs.append(_shown(value, {"output_type": "execute_result", "execution_count": number}))
    return outputs + _figures()


def _is_plot(value: Any) -> bool:
    """What matplotlib's functions return, which is shown as their figure."""
    return "matplotlib" in type(value).__module__ or (isinstance(value, list) and bool(value) and _is_plot(value[0]))


def _shown(value: Any, output: dict[str, Any]) -> dict[str, Any]:
    data: dict[str, Any] = {"text/plain": [re.sub(r" at 0x[0-9a-f]+", "", repr(value))[:200]]}
    if hasattr(value, "_repr_html_"):
        data["text/html"] = [value._repr_html_()]
    elif hasattr(value, "_repr_png_"):
        data["image/png"] = base64.b64encode(value._repr_png_()).decode()
    return output | {"data": data, "metadata": {}}


def _figures() -> list[dict[str, Any]]:
    """The figures that are open, which are closed."""
    if "matplotlib.pyplot" not in sys.modules:
        return []
    from matplotlib import pyplot

    outputs = []
    for number in pyplot.get_fignums():
        file = io.BytesIO()
        pyplot.figure(number).savefig(file, format="png", dpi=72, bbox_inches="tight", metadata={"Software": None})
        data = {"image/png": base64.b64encode(file.getvalue()).decode(), "text/plain": ["<Figure>"]}
        outputs.append({"output_type": "display_data", "data": data, "metadata": {}})
    pyplot.close("all")
    return outputs


def read(path: Path) -> dict[str, Any]:
    return json.loads(path.read_text(encoding="utf-8"))


def told(notebook: dict[str, Any]) -> list[list[str]]:
    """What each cell prints, its numbers left open but for zeros, as times and processors differ, and what it shows."""

    def number(found: re.Match[str]) -> str:
        return "0" if not found[0].strip("0,.%") else "#"

    cells = []
    for cell in code_cells(notebook):
        outputs = cell["outputs"]
        text = "".join("".join(output.get("text", ())) for output in outputs)
        kinds = [f"<{kind}>" for output in outputs for kind in sorted(output.get("data", ()))]
        cells.append([" ".join(re.sub(r"-?\d[\d,.]*%?", number, text).split()), *kinds])
    return cells


def main() -> int:
    sys.path.insert(0, str(ROOT))
    os.environ.setdefault("MPLCONFIGDIR", str(ROOT / ".cache" / "matplotlib"))
    names = [name for name in sys.argv[1:] if name != CHECK]
    for path in [Path(name).absolute() for name in names] or sorted(FOLDER.glob("*.ipynb")):
        notebook = read(path)
        before = told(notebook)
        run(notebook)
        if CHECK in sys.argv:
            if told(notebook) != before:
                print(f"{path.name}: its cells say something else now: {told(notebook)}, not {before}", file=sys.stderr)
                return 1
            continue
        path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        print(path.relative_to(ROOT))
    return 0


if __name__ == "__main__":
    sys.exit(main())
