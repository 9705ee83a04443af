"""Finds the numbers of a text that could be measurements and therefore need a query or a mark.

These numbers do: numbers with a decimal point or an exponent, with a unit or a word of UNITS after them, and numbers of
1000 or more; in the body of a table every cell that is a number. These do not: code, links, headings, numbers of list
items, versions (`0.1.0`, `Gmsh 4.1`), years, parts of names (`C3D4`), powers of small whole numbers (`2^31`), and
smaller whole numbers without a unit, which count things of the text.
"""
import re
from dataclasses import dataclass

UNITS = ("%", "x", "times", "M", "k", "million", "thousand", "billion", "cells", "ns", "us", "ms", "s", "seconds",
         "second", "min", "minute", "minutes", "h", "hour", "hours", "cycles", "bytes", "B", "KiB", "MiB", "GiB", "TiB",
         "kB", "MB", "GB", "TB", "GHz", "MHz", "mm", "degrees", "points")
VERSIONED = ("Gmsh", "CGAL", "Debian", "VTK", "likwid", "Python", "FEniCS", "hwloc", "Clang", "clang-format", "GCC",
             "MPI", "TetGen", "CMake", "Table", "Tables", "Figure", "Fig.", "section", "Section", "equation", "eq.",
             "rule", "version", "INR", "XDMF", "licence", "gmsh-version", "EPYC", "Procedia Engineering")
NUMBER = re.compile(r"(?<![\w.^/#§])(?<![A-Za-z]-)(?<!\d[,:-])(?P<sign>[-+](?=\d))?"
                    r"(?P<digits>\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?)"
                    r"(?!\.\d)(?![A-Za-z_]*\d*\()")
NOTHING = "\0"  # replaces comments, which the page does not show: a unit may follow a comment
AFTER = re.compile(rf"\0*[\s-]?(?:{'|'.join(map(re.escape, UNITS))})(?![\w/-]*\w\()(?!\w)")
CELL = re.compile(r"[*~<> \u25cb\u25c7]*[-+]?\d[\d,.]*(?:e[-+]?\d+)?[\s\0]*(?:%|[A-Za-z/]{0,4})?[* \0]*")


@dataclass(frozen=True)
class Number:
    """`start` and `end`: the place in the text of the page."""

    start: int
    end: int
    text: str


def numbers_to_cover(text, body_cells):
    """Yields the numbers of `text`, in which all that is not prose is blank. `body_cells`: (start, end) of table
    cells."""
    whole_cells = {place for start, end in body_cells if CELL.fullmatch(text[start:end]) for place in range(start, end)}
    for found in NUMBER.finditer(text):
        if found.start("digits") in whole_cells or _is_suspect(text, found):
            yield Number(found.start("digits"), found.end("digits"), found["digits"])


def _is_suspect(text, found):
    digits, before, after = found["digits"], text[max(0, found.start() - 24):found.start()], text[found.end():]
    if after[:1] == "^" and digits != "10" or re.match(r"[\w(]", after) and not AFTER.match(after):
        return False
    if any(re.search(rf"(?<!\w){re.escape(name)} $", before) for name in VERSIONED):
        return False
    is_year = re.fullmatch(r"(?:19|20)\d\d", digits)
    return bool("." in digits or "e" in digits or AFTER.match(after)
                or len(digits.replace(",", "")) > 3 and not is_year)
