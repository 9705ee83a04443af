"""Prints the stub of podm/meshing.py: the keywords of podm.mesh and podm.plan with their types.

Usage: make_stub.py OPTIONS.json

OPTIONS.json is the output of `podm options`.
"""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "podm"))  # the package itself needs the extension module
from keywords import TYPES, default_of, options_of_mesh, options_of_plan  # noqa: E402

HEAD = '''"""Types of podm.mesh and podm.plan; meshing.py has their descriptions."""

import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy.typing as npt

from . import _podm
from .result import Mesh

StrPath = str | os.PathLike[str]
LabelValues = str | int | Iterable[int]
'''

OF_THE_IMAGE = ["labels: npt.ArrayLike | StrPath", "*", "affine: npt.ArrayLike | None = None",
                "spacing: npt.ArrayLike | None = None", "names: Mapping[int, str] | StrPath | None = None"]


def parameter(option):
    return f"{option['keyword']}: {TYPES[option['kind']]} = {default_of(option)}"


def definition(name, parameters, result):
    return f"def {name}(" + ",\n         ".join(parameters) + f") -> {result}: ..."


def stub(options):
    progress = "progress: Callable[[_podm.Progress], object] | None = None"
    keywords_of_mesh = map(parameter, options_of_mesh(options))
    keywords_of_plan = map(parameter, options_of_plan(options))
    return "\n\n".join([HEAD, definition("mesh", [*OF_THE_IMAGE, progress, *keywords_of_mesh], "Mesh"),
                        definition("plan", [*OF_THE_IMAGE, *keywords_of_plan], "dict[str, Any]")])


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        print(stub(json.load(file)))
