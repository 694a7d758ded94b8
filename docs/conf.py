"""How Sphinx builds the documentation: `make docs` writes it to build/docs."""

from __future__ import annotations

import json
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

_about = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

project = "Shadowcull"
author = _about["authors"][0]["name"]
release = version = _about["version"]
copyright = author

extensions = ["myst_parser", "numpydoc", "sphinx.ext.autodoc"]
exclude_patterns = ["_build"]
source_suffix = {".md": "markdown", ".ipynb": "markdown"}  # as `read_notebook` writes it
default_role = "code"  # `name` in docstrings means code

html_theme = "furo"
html_title = "Shadowcull"
html_favicon = "../assets/icon.png"
html_logo = "../assets/icon.png"
html_show_sphinx = False
html_copy_source = False
html_theme_options = {"sidebar_hide_name": False}

myst_heading_anchors = 3  # links to headings are checked, as on any page that shows Markdown
myst_enable_extensions = ["colon_fence"]

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_preserve_defaults = True
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False

linkcheck_timeout = 20

# Pages that are files at the top of the project: their links are those of that folder.
SHARED = {
    "architecture": "ARCHITECTURE.md",
    "contributing": "CONTRIBUTING.md",
    "changes": "CHANGELOG.md",
    "security": "SECURITY.md",
}


def read_shared(app: Sphinx, page: str, source: list[str]) -> None:
    """Put the file in the place of the page that only points to it."""
    if page in SHARED:
        app.env.note_dependency(ROOT / SHARED[page])
        pages = {file: f"{name}.md" for name, file in SHARED.items()}
        text = (ROOT / SHARED[page]).read_text()
        source[0] = re.sub(r"\]\((?:docs/)?([\w/.-]+)", lambda link: f"]({pages.get(link[1], link[1])}", text)


def read_notebook(app: Sphinx, page: str, source: list[str]) -> None:
    """Write a notebook as Markdown, with what its cells printed and showed when they were last run."""
    if app.env.doc2path(page).suffix == ".ipynb":
        source[0] = "\n\n".join(part for cell in json.loads(source[0])["cells"] for part in _parts(cell))


def _parts(cell: dict) -> Iterator[str]:
    text = "".join(cell["source"])
    if cell["cell_type"] == "markdown":
        yield text
        return
    yield f"```python\n{text}\n```"
    for output in cell["outputs"]:
        data = output.get("data", {})
        if "text/html" in data:
            html = "".join(data["text/html"])
            yield f"```{{raw}} html\n{html}\n```"
        elif "image/png" in data:
            image = f'<img alt="What the cell draws" src="data:image/png;base64,{data["image/png"]}">'
            yield f"```{{raw}} html\n{image}\n```"
        else:
            printed = "".join(output.get("text", data.get("text/plain", ())))
            yield f"```text\n{printed}\n```"


def setup(app: Sphinx) -> None:
    app.connect("source-read", read_shared)
    app.connect("source-read", read_notebook)


# Their pages are on the network, where a build has no business: these names are not looked up.
nitpick_ignore_regex = [
    ("py:.*", r"numpy\..*"),
    ("py:class", r"collections\.Counter"),
]
