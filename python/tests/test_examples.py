"""The numbered examples, the notebook and the code of docs/python run, and docs/python is current. The example with Ray is run by test_ray.py."""

from __future__ import annotations

import json
import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("0[1-5]_*.py")), ids=lambda path: path.stem)
def test_an_example_runs(path: Path, tmp_path: Path) -> None:
    run = subprocess.run(
        [sys.executable, str(path)], cwd=tmp_path, env={"PYTHONPATH": str(EXAMPLES.parent)}, capture_output=True, text=True
    )
    assert run.returncode == 0 and run.stdout, run.stderr


@pytest.mark.parametrize("path", sorted((EXAMPLES / "pictures").glob("*.py")), ids=lambda path: path.stem)
def test_a_picture_is_drawn(path: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    environment = {"PYTHONPATH": str(EXAMPLES.parent), "MPLBACKEND": "agg", "MPLCONFIGDIR": str(tmp_path)}
    run = subprocess.run([sys.executable, str(path)], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert run.returncode == 0 and (tmp_path / f"{path.stem}.png").is_file(), run.stderr


def test_the_pages_of_the_classes_are_current() -> None:
    pytest.importorskip("griffe2md")
    pages = runpy.run_path(str(EXAMPLES.parent / "document.py"))["main"]()
    folder = EXAMPLES.parents[1] / "docs/python"
    assert {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()} == pages, "run python/document.py"


def test_the_notebook_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its cells, one after the other, without a kernel."""
    pytest.importorskip("pandas")
    pytest.importorskip("matplotlib").use("agg")
    names: dict[str, Any] = {}
    for cell in json.loads((EXAMPLES / "first_look.ipynb").read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    assert len(names["found"]) > 0 and names["found"]._repr_html_()
    names["plt"].close("all")
