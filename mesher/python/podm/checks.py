"""Checks of values, and the messages about unexpected values."""

from __future__ import annotations

import numbers
import os
from collections.abc import Callable
from typing import Any

import numpy as np

from .errors import Error


def expect(is_expected: bool, keyword: str, expected: str, value: Any) -> None:
    if not is_expected:
        raise Error(f"{keyword}: {expected} is expected, not {value!r}")


def is_bool(value: Any) -> bool:
    return isinstance(value, (bool, np.bool_))


def is_number(value: Any) -> bool:
    return isinstance(value, numbers.Real) and not is_bool(value)


def is_label_value(value: Any) -> bool:
    return isinstance(value, numbers.Integral) and not is_bool(value) and 0 <= value < 2**32


def path_bytes(keyword: str, path: Any) -> bytes:
    """Returns the name of a file in the system's encoding, which need not be UTF-8."""
    return _encoded(keyword, "the name of a file", path, os.fsencode)


def text_bytes(keyword: str, text: Any) -> bytes:
    """Returns the text in UTF-8."""
    return _encoded(keyword, "text", text, str.encode)


def _encoded(keyword: str, expected: str, text: Any, encode: Callable[[Any], bytes]) -> bytes:
    """Refuses NUL: C++ takes any bytes, but its libraries end at a NUL and would write or read another file."""
    try:
        encoded = encode(text)
    except (TypeError, UnicodeEncodeError):
        encoded = None
    expect(encoded is not None and b"\0" not in encoded, keyword, f"{expected}, without NUL or lone surrogates,", text)
    return encoded
