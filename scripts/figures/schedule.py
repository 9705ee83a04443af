"""The leaf grid and the schedule of a run; verifiers/schedule.h describes the format."""
import json
from dataclasses import dataclass

import numpy

SCHEMA = "podm-schedule/1"


class ScheduleError(Exception):
    """A schedule that cannot be read; the text names the file, the line and the fault."""


@dataclass(frozen=True)
class Schedule:
    mesh_to_grid: numpy.ndarray  # 3 x 4
    leaves: numpy.ndarray  # n x 4: i, j, k, side
    activations: list  # dicts of the file


def read_schedule(path):
    """Reads a schedule. Raises ScheduleError."""
    try:
        with open(path) as file:
            lines = [(number, line) for number, line in enumerate(file, start=1) if line.strip()]
    except OSError as error:
        raise ScheduleError(f"{path}: {error.strerror}") from None
    rows = []
    for number, line in lines:
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError as error:
            raise ScheduleError(f"{path}:{number}: not JSON: {error.msg}") from None
    if not rows or rows[0].get("schema") != SCHEMA:
        found = rows[0].get("schema") if rows else "an empty file"
        raise ScheduleError(f"{path}: schema {found!r}; this program reads {SCHEMA}")
    head = rows[0]
    return Schedule(numpy.reshape(head["mesh_to_grid"], (3, 4)), numpy.array(head["leaves"]).reshape(-1, 4), rows[1:])


def rings(leaves, leaf):
    """Returns the indices of the first ring, all leaves that touch `leaf`, and of the second, leaves that touch the
    first."""
    first = _touching(leaves, [leaf])
    second = _touching(leaves, [leaf, *numpy.flatnonzero(first)]) & ~first
    first[leaf] = second[leaf] = False
    return numpy.flatnonzero(first), numpy.flatnonzero(second)


def _touching(leaves, some):
    low, high = leaves[:, :3], leaves[:, :3] + leaves[:, 3:]
    found = numpy.zeros(len(leaves), dtype=bool)
    for one in some:
        found |= numpy.all((low <= high[one]) & (high >= low[one]), axis=1)
    return found


def active_pair(schedule):
    """Returns two activations of leaves on different nodes at the same time, both cut by a plane of constant k, and
    that k. Chooses the two with the most operations. None if the run had no such pair."""
    by_work = sorted(schedule.activations, key=lambda one: -one.get("operations", 0))[:500]
    best = None
    for position, one in enumerate(by_work):
        for other in by_work[position + 1 :]:
            if best and one["operations"] + other["operations"] <= best[0]:
                break
            together = one["begin_s"] < other["end_s"] and other["begin_s"] < one["end_s"]
            if not together or one["node"] == other["node"]:
                continue
            low, high = _common_k(schedule.leaves[one["leaf"]], schedule.leaves[other["leaf"]])
            if low < high:
                best = (one["operations"] + other["operations"], one, other, (low + high) / 2)
    return best and best[1:]


def _common_k(leaf, other):
    return max(leaf[2], other[2]), min(leaf[2] + leaf[3], other[2] + other[3])
