"""Finds what can be grasped and moved in an RGB-D image: pixels, 3D boxes, what stands on what, and why.

`discover` is the one call that most users need; `Pipeline` is for streams and for tuning, `Tracker` for video. `open` reads
files, `synthetic` makes scenes with a truth, and `score` holds labels against it.
"""

from objecthood._native import Capture, Estimates, __version__
from objecthood.discovery import PARTS, Boxes, Discovery, Object, SupportEdge
from objecthood.errors import FileError, InputError, ObjecthoodError, ParameterError
from objecthood.evaluation import Score, score, synthetic
from objecthood.files import Source, open, read_images
from objecthood.params import Params
from objecthood.pipeline import Pipeline, discover
from objecthood.tracker import Tracked, Tracker

__all__ = [
    "PARTS",
    "Boxes",
    "Capture",
    "Discovery",
    "Estimates",
    "FileError",
    "InputError",
    "Object",
    "ObjecthoodError",
    "ParameterError",
    "Params",
    "Pipeline",
    "Score",
    "Source",
    "SupportEdge",
    "Tracked",
    "Tracker",
    "__version__",
    "discover",
    "open",
    "read_images",
    "score",
    "synthetic",
]
