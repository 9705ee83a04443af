"""Filters: conditions on rows, `trial=1M-both,* cells>=1e6 status!=ok`."""
import fnmatch
import operator
import re
import shlex

from .errors import DocsError
from .expression import Expression, Missing

ORDERS = {">=": operator.ge, "<=": operator.le, ">": operator.gt, "<": operator.lt}
CONDITION = re.compile(r"([\w.\[\]]+)(!=|>=|<=|=|>|<)(.*)", re.DOTALL)


class Filter:
    """`=` compares numbers by value and words by pattern, with the wildcards * and ?. A value that a row lacks is
    `none`."""

    def __init__(self, conditions):
        self._conditions = conditions

    def matches(self, row):
        return all(_holds(_value(path, row), sign, wanted) for path, sign, wanted in self._conditions)

    def unknown_to(self, rows):
        """Returns the paths that no row has, which are most often typing errors."""
        return [path for path, *_ in self._conditions if all(_value(path, row) is None for row in rows)]

    def changed(self, other):
        """Returns this filter with the conditions of `other` in place of its own conditions on the same paths."""
        theirs = {path for path, *_ in other._conditions}
        return Filter([one for one in self._conditions if one[0] not in theirs] + other._conditions)

    def and_also(self, other):
        return Filter(self._conditions + other._conditions)


def parse_filter(text):
    conditions = []
    for word in shlex.split(text):
        found = CONDITION.fullmatch(word)
        if not found:
            raise DocsError(f"'{word}' is not a condition: path=value, !=, >=, <=, > or <")
        conditions.append(found.groups())
    return Filter(conditions)


def _value(path, row):
    try:
        return Expression(path).of(row)
    except Missing:
        return None


def _holds(value, sign, wanted):
    number = _number(wanted)
    if sign in ORDERS:
        return isinstance(value, (int, float)) and number is not None and ORDERS[sign](value, number)
    if isinstance(value, (int, float)) and not isinstance(value, bool) and number is not None:
        equal = value == number
    else:
        equal = fnmatch.fnmatchcase(_word(value), wanted)
    return equal == (sign == "=")


def _word(value):
    return str(value).lower() if isinstance(value, (bool, type(None))) else str(value)


def _number(text):
    try:
        return float(text)
    except ValueError:
        return None
