"""The keywords of podm.mesh and podm.plan, from the options that the program declares.

The package and make_stub.py share this file; it therefore imports nothing of the package.
"""

from __future__ import annotations

from typing import Any

Option = dict[str, Any]  # an object of the output of `podm options`

TYPES = {"flag": "bool", "choice": "str | None", "real": "float | None", "integer": "int | None",
         "file": "StrPath | None", "text": "str | int | None", "two reals": "tuple[float, float] | None",
         "lengths of labels": "Mapping[str | int, float] | None",
         "lengths of pairs of labels":
             "Mapping[tuple[str | int, str | int], float | tuple[float, float]] | None",
         "label values": "LabelValues | None", "integers": "LabelValues | None",
         "names of label values": "Mapping[str, LabelValues] | None"}
"""The type of a keyword, by the kind of its option."""


def options_of_mesh(options: list[Option]) -> list[Option]:
    return [option for option in options if "python" in option["uses"] and option["keyword"] != "names"]


def options_of_plan(options: list[Option]) -> list[Option]:
    return [option for option in options_of_mesh(options) if "plan" in option["uses"] or option["group"] == "Labels"]


def default_of(option: Option) -> bool | None:
    """The keyword's own default, which only means that the keyword was not given."""
    return False if option["kind"] == "flag" else None
