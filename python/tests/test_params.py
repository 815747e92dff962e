"""Parameters: made from the table of the library, and read as the command line reads them."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import pytest

import objecthood as oh
from objecthood import _native, params


def test_the_module_is_that_of_the_table() -> None:
    generate = Path(__file__).parents[1] / "generate_params.py"
    made = subprocess.run(
        [sys.executable, "-c", f"import runpy; print(runpy.run_path({str(generate)!r})['main'](), end='')"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert made.stdout == Path(params.__file__).read_text(encoding="utf-8"), "run python/generate_params.py"


def test_defaults_are_those_of_the_library() -> None:
    library = json.loads(_native.params_from_toml(""))
    assert asdict(oh.Params()) == library
    assert oh.Params.from_json(oh.Params().to_json()) == oh.Params()


def test_toml_comes_back_and_is_checked() -> None:
    params = oh.Params()
    params.method = "paper"
    params.curvature.threshold = 0.3
    params.graph.min_size_px = 50
    assert oh.Params.from_toml(params.to_toml()) == params
    assert oh.Params.from_toml("[objectness]\nthreshold = 0.25\n").objectness.threshold == 0.25
    for text in ("[objectness]\ntreshold = 1", "[objectness]\nthreshold = 2", "method = 'magic'", "x", "[graph]\nmin_size_px = 1.5"):
        with pytest.raises(oh.ParameterError):
            oh.Params.from_toml(text)


def test_names_are_fixed() -> None:
    params = oh.Params()
    with pytest.raises(AttributeError):
        params.objectness.treshold = 1  # type: ignore[attr-defined]
    params.curvature.threshold = float("nan")
    with pytest.raises(oh.ParameterError):
        oh.Pipeline(params)


def test_a_profile_sets_its_lateral_noise() -> None:
    assert oh.Params().with_profile("tof").sensor.lateral_noise_px != oh.Params().sensor.lateral_noise_px
    own = oh.Params()
    own.sensor.lateral_noise_px = 0.5
    assert own.with_profile("tof").sensor.lateral_noise_px == 0.5


def test_the_command_line_reads_them(program: Path, tmp_path: Path) -> None:
    said = subprocess.run([program, "params", "--toml", "--set", "objectness.threshold=0.3"], capture_output=True, text=True, check=True)
    assert oh.Params.from_toml(said.stdout).objectness.threshold == 0.3
    mine = oh.Params()
    mine.objectness.threshold = 0.4
    (tmp_path / "mine.toml").write_text(mine.to_toml())
    said = subprocess.run([program, "params", "--json", "--config", tmp_path / "mine.toml"], capture_output=True, text=True, check=True)
    rows = {row["name"]: row["value"] for row in json.loads(said.stdout)["parameters"]}
    assert rows["objectness.threshold"] == 0.4
