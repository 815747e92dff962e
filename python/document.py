"""Writes docs/python, a page for each class: its docstrings, and code with the picture that it draws. `python document.py`; needs griffe2md and
matplotlib. A test compares the pages, and runs the code."""

from __future__ import annotations

import os
import runpy
from pathlib import Path

import griffe
from griffe2md import default_config, render_object_docs

HERE = Path(__file__).parent
DOCS = HERE.parent / "docs"
PICTURES = "pictures/python"

PAGES = {
    "discovery": ("Discovery", "discover", "Estimates", "Boxes", "SupportEdge"),
    "object": ("Object",),
    "pipeline": ("Pipeline",),
    "params": ("Params",),
    "source": ("Source", "open", "read_images"),
    "capture": ("Capture", "synthetic"),
    "tracker": ("Tracker", "Tracked"),
    "score": ("Score", "score"),
}
"""The classes and functions of each page. The first gives it its title."""

CONFIG = {
    **default_config,
    "members_order": "source",
    "show_object_full_path": False,
    "show_root_full_path": False,
    "show_root_members_full_path": False,
    "show_signature_annotations": True,
    "summary": False,
    "line_length": 140,
    # Arrays become captures by `discover`.
    "filters": ["!^_", "!^of_"],
}

NOTE = "<!-- Made by `python document.py` in python/; do not edit. -->"


def main() -> dict[str, str]:
    """The text of every page, by its file in docs/python."""
    package = griffe.load("objecthood", search_paths=[HERE], resolve_aliases=True, allow_inspection=False)
    pages = {f"{name}.md": _page(name, [package[thing] for thing in things]) for name, things in PAGES.items()}
    rows = [f"| [{things[0]}]({name}.md) | {_summary(package[things[0]])} |" for name, things in PAGES.items()]
    pages["README.md"] = "\n".join([NOTE, "", "# Classes of the Python package", "", "| class | what it is |", "|---|---|", *rows, ""])
    return pages


def draw() -> None:
    """Runs the code of every page in the folder of the pictures."""
    (DOCS / PICTURES).mkdir(parents=True, exist_ok=True)
    os.chdir(DOCS / PICTURES)
    for name in PAGES:
        runpy.run_path(str(_example(name)))


def _example(name: str) -> Path:
    return HERE / "examples/pictures" / f"{name}.py"


def _page(name: str, things: list[griffe.Object]) -> str:
    caption, _, code = _example(name).read_text(encoding="utf-8").removeprefix('"""').partition('"""\n')
    picture = f"![{caption}](../{PICTURES}/{name}.png)"
    parts = [NOTE, f"# {things[0].name}", _summary(things[0]), picture, caption, f"```python\n{code.strip()}\n```"]
    parts += [render_object_docs(thing, CONFIG).strip() for thing in things]
    return "\n\n".join(parts) + "\n"


def _summary(thing: griffe.Object) -> str:
    return thing.docstring.value.splitlines()[0] if thing.docstring else ""


if __name__ == "__main__":
    (DOCS / "python").mkdir(exist_ok=True)
    for file, content in main().items():
        (DOCS / "python" / file).write_text(content, encoding="utf-8")
    draw()
