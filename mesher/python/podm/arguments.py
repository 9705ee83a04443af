"""Keywords become the options of the program: it knows their defaults, and what it refuses."""

from __future__ import annotations

import numbers
import os
from collections.abc import Iterable, Mapping
from typing import Any

from .errors import Error

OPTION_OF = {"keep": "labels", "names": "label-names"}
"""Where the keyword is not the option's name."""


def command_line(keywords: Mapping[str, Any]) -> list[str]:
    """The options that stand for keywords; those that are None are left to the program."""
    return [argument for keyword, value in keywords.items() if value is not None
            for argument in _arguments(keyword, value)]


def _arguments(keyword: str, value: Any) -> list[str]:
    option = "--" + OPTION_OF.get(keyword, keyword.replace("_", "-"))
    if isinstance(value, bool):
        return [option] if value else []
    return [f"{option}={text}" for text in _TEXTS_OF.get(keyword, _one_text)(keyword, value)]


def _text(value: Any) -> str:
    """The shortest text that reads back to the same; 1e6 counts like 1000000."""
    if isinstance(value, numbers.Integral) or isinstance(value, float) and value.is_integer():
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    return os.fspath(value)


def _expect(is_expected: bool, keyword: str, expected: str, value: Any) -> None:
    if not is_expected:
        raise Error(f"{keyword}: {expected} is expected, not {value!r}")


def _one_text(keyword: str, value: Any) -> list[str]:
    _expect(isinstance(value, (numbers.Real, str, os.PathLike)), keyword, "a number or a text", value)
    return [_text(value)]


def _two_texts(keyword: str, value: Any) -> list[str]:
    if isinstance(value, str):
        return [value]
    values = list(value) if isinstance(value, Iterable) else []
    are_numbers = len(values) == 2 and all(isinstance(number, numbers.Real) for number in values)
    _expect(are_numbers, keyword, "a pair of numbers", value)
    return [",".join(map(_text, values))]


def _length_of_labels(keyword: str, value: Any) -> list[str]:
    _expect(isinstance(value, Mapping), keyword, 'a dict from names or values of labels to mm, as {"liver": 2},', value)
    for label, length in value.items():
        is_label = isinstance(label, (str, numbers.Integral)) and not isinstance(label, bool)
        _expect(is_label, keyword, "a label's name or value", label)
        _expect(isinstance(length, numbers.Real), keyword, f"a length in mm for {label!r}", length)
    return [f"{label}={_text(length)}" for label, length in value.items()]


def _label_values(keyword: str, value: Any) -> list[str]:
    if isinstance(value, str):
        return [value]
    values = [value] if isinstance(value, numbers.Integral) else list(value) if isinstance(value, Iterable) else [None]
    are_values = all(isinstance(label, numbers.Integral) for label in values)
    _expect(are_values, keyword, 'label values, as [1, 3, 4] or "1,3-4",', value)
    return [",".join(map(_text, values))] if values else []


def _merges(keyword: str, value: Any) -> list[str]:
    _expect(isinstance(value, Mapping), keyword, 'a dict from names to label values, as {"kidney": [2, 3]},', value)
    return [f"{text}={name}" for name, values in value.items() for text in _label_values(keyword, values)]


_TEXTS_OF = {"radius_of": _length_of_labels, "keep": _label_values, "drop": _label_values, "merge": _merges,
             "dihedral_bounds": _two_texts}
