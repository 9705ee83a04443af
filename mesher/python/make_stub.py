"""Prints the stub of podm/meshing.py: the keywords of podm.mesh and podm.plan with their types.

Usage: make_stub.py OPTIONS.json

OPTIONS.json is the output of `podm options`.
"""
import json
import sys

TYPES = {"flag": "bool", "choice": "str | None", "real": "float | None", "integer": "int | None",
         "file": "StrPath | None", "text": "str | int | None", "two reals": "tuple[float, float] | None",
         "lengths of labels": "Mapping[str | int, float] | None",
         "lengths of pairs of labels":
             "Mapping[tuple[str | int, str | int], float | tuple[float, float]] | None",
         "label values": "LabelValues | None", "names of label values": "Mapping[str, LabelValues] | None"}

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
    return f"{option['keyword']}: {TYPES[option['kind']]} = {'False' if option['kind'] == 'flag' else 'None'}"


def definition(name, parameters, result):
    return f"def {name}(" + ",\n         ".join(parameters) + f") -> {result}: ..."


def stub(options):
    of_python = [option for option in options if "python" in option["uses"] and option["keyword"] != "names"]
    of_plan = [option for option in of_python if "plan" in option["uses"] or option["group"] == "Labels"]
    progress = "progress: Callable[[_podm.Progress], object] | None = None"
    return "\n\n".join([HEAD, definition("mesh", [*OF_THE_IMAGE, progress, *map(parameter, of_python)], "Mesh"),
                        definition("plan", [*OF_THE_IMAGE, *map(parameter, of_plan)], "dict[str, Any]")])


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        print(stub(json.load(file)))
