"""What the tests share: one synthetic frame, and where real data and the command line are."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import objecthood as oh

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def scene() -> oh.Capture:
    """Things on a table, seen by a Kinect."""
    return oh.synthetic("tabletop", 7)


@pytest.fixture(scope="session")
def found(scene: oh.Capture) -> oh.Discovery:
    """What is found in it."""
    return oh.discover(scene)


@pytest.fixture(scope="session")
def learn() -> list[Path]:
    """The real scenes of mOSD."""
    folder = Path(os.environ.get("OBJECTHOOD_DATA", ROOT.parent / "shared" / "data")) / "mosd" / "learn"
    if not folder.is_dir():
        pytest.skip(f"skipped: no real data in {folder}")
    return sorted(folder.glob("*.pcd"), key=lambda path: (len(path.name), path.name))


@pytest.fixture(scope="session")
def program() -> Path:
    """The command line, as the tests of Rust build it."""
    path = Path(os.environ.get("OBJECTHOOD_PROGRAM", ROOT / "target" / "debug" / "objecthood"))
    if not path.exists():
        pytest.skip(f"skipped: no program at {path}")
    return path
