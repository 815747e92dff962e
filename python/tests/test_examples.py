"""The numbered examples and the notebook run. That with Ray is run by test_ray.py."""

from __future__ import annotations

import json
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
