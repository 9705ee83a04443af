"""Conversion of keywords to options of the program, which has the defaults and refuses bad values."""

from __future__ import annotations

import numbers
import os
from collections.abc import Iterable, Mapping
from typing import Any

from .checks import expect, is_bool, is_label_value, is_number, path_bytes, text_bytes

OPTION_OF = {"keep": "labels", "names": "label-names"}
"""Where the keyword is not the option's name."""

FLAGS = {"optimize", "oversubscribe"}
"""Options without a value."""

_PATHS = {"names", "size_image", "topology", "crossover"}


def command_line(keywords: Mapping[str, Any]) -> list[bytes]:
    """Returns the options for the keywords. Keywords that are None are left to the program."""
    return [argument for keyword, value in keywords.items() if value is not None
            for argument in _arguments(keyword, value)]


def _arguments(keyword: str, value: Any) -> list[bytes]:
    option = b"--" + OPTION_OF.get(keyword, keyword.replace("_", "-")).encode()
    if keyword in FLAGS:
        expect(is_bool(value), keyword, "True or False", value)
        return [option] if value else []
    encoded = path_bytes if keyword in _PATHS else text_bytes
    return [option + b"=" + encoded(keyword, text) for text in _TEXTS_OF.get(keyword, _one_text)(keyword, value)]


def number_or_text(keyword: str, value: Any) -> bytes:
    """Returns the value as an option takes it."""
    return text_bytes(keyword, *_one_text(keyword, value))


def _text(value: Any) -> str:
    """Returns the shortest text that reads back to the same value; 1e6 counts like 1000000."""
    if isinstance(value, numbers.Integral) or isinstance(value, float) and value.is_integer():
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    return os.fsdecode(value)


def _one_text(keyword: str, value: Any) -> list[str]:
    expect(is_number(value) or isinstance(value, (str, os.PathLike)), keyword, "a number or a text", value)
    return [_text(value)]


def _two_texts(keyword: str, value: Any) -> list[str]:
    if isinstance(value, str):
        return [value]
    values = list(value) if isinstance(value, Iterable) else []
    expect(len(values) == 2 and all(map(is_number, values)), keyword, "a pair of numbers", value)
    return [",".join(map(_text, values))]


def _length_of_labels(keyword: str, value: Any) -> list[str]:
    expect(isinstance(value, Mapping), keyword, 'a dict from names or values of labels to mm, as {"liver": 2},', value)
    for label, length in value.items():
        expect(isinstance(label, str) or is_label_value(label), keyword, "a label's name or value", label)
        expect(is_number(length), keyword, f"a length in mm for {label!r}", length)
    return [f"{label}={_text(length)}" for label, length in value.items()]


def _sizes_near_labels(keyword: str, value: Any) -> list[str]:
    expect(isinstance(value, Mapping), keyword, 'a dict from pairs of labels to mm, as {("liver", 0): 1},', value)
    texts = []
    for pair, size in value.items():
        are_labels = isinstance(pair, tuple) and len(pair) == 2 and all(isinstance(label, str) or is_label_value(label)
                                                                        for label in pair)
        expect(are_labels, keyword, "a pair of labels, by name or value,", pair)
        lengths = size if isinstance(size, tuple) else (size,)
        are_lengths = len(lengths) in (1, 2) and all(map(is_number, lengths))
        expect(are_lengths, keyword, f"a length in mm, or one and a width, for {pair!r}", size)
        texts.append(",".join(map(str, pair)) + "=" + ":".join(map(_text, lengths)))
    return texts


def _file_of_sizes(keyword: str, value: Any) -> list[str]:
    expect(isinstance(value, (str, os.PathLike)), keyword, "the name of a file", value)
    return [_text(value)]


def _label_values(keyword: str, value: Any) -> list[str]:
    if isinstance(value, str):
        return [value]
    values = list(value) if isinstance(value, Iterable) else [value]
    are_values = bool(values) and all(map(is_label_value, values))
    expect(are_values, keyword, 'one or some label values, 0 to 2^32 - 1, as [1, 3, 4] or "1,3-4",', value)
    return [",".join(map(_text, values))]


def _merges(keyword: str, value: Any) -> list[str]:
    expect(isinstance(value, Mapping), keyword, 'a dict from names to label values, as {"kidney": [2, 3]},', value)
    for name in value:
        expect(isinstance(name, str), keyword, "a name", name)
    return [f"{text}={name}" for name, values in value.items() for text in _label_values(keyword, values)]


def _file_of_names(keyword: str, value: Any) -> list[str]:
    is_file = isinstance(value, (str, os.PathLike))
    expect(is_file, keyword, 'a dict from label values to names, as {1: "liver"}, or the name of a file', value)
    return [_text(value)]


_TEXTS_OF = {"radius_of": _length_of_labels, "size_image": _file_of_sizes, "size_near": _sizes_near_labels,
             "keep": _label_values, "drop": _label_values, "merge": _merges,
             "dihedral_bounds": _two_texts, "names": _file_of_names}
