"""Finds where a claim asks for less than an earlier definition did."""
from . import definitions


def weakened(life, claim):
    """Returns, in words, each way in which the current claim asks for less than an earlier definition of it."""
    found = []
    for before in life.definitions():
        found += [_bound_in_words(*one) for one in definitions.loosened(before, claim)]
        found += [f"{name} no longer has {', '.join(map(str, lost))}" for name, lost in
                  definitions.narrowed(before, claim)]
        found += [f"{name} was {old}, is {new}" for name, old, new in definitions.changed_measure(before, claim)]
    return list(dict.fromkeys(found))


def was_loosened(life):
    """Returns (before, after) of the first change that loosened a bound, even if it was restored later; None without
    one."""
    for change in life.changes:
        if change.before and change.after and definitions.loosened(change.before, change.after):
            return change.before, change.after
    return None


def _bound_in_words(name, old, new):
    return f"{name} loosened from {old} to {'nothing' if new is None else new}"
