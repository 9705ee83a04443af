"""Weak-scaling series: verified rows of one machine, program and input whose cells grow in step with the cores.

Speed-up follows equation 1 of the paper: cells per second over those of PODM on one core; efficiency is speed-up
over cores. Seconds are all phases but `write`.
"""
from dataclasses import dataclass

import numpy
import pandas

from .spread import median_interval, ratio_interval

KEY = ["basis", "machine", "build", "experiment", "input.path"]
# Cells per core may stray this far from one core's; the paper's own stray by 3 %, --target-elements by 5 %.
WEAK_TOLERANCE = 0.10
PHASES = ["read", "transform", "octree", "initial", "refine", "extract"]


@dataclass(frozen=True)
class Series:
    """`key`: values of KEY by name. `table`: indexed by (algorithm, cores), medians with their bounds and n."""

    key: dict
    cells_per_core: float
    table: pandas.DataFrame

    def label(self):
        key = self.key
        return f"{key['experiment']}, {key['input.path']}, {self.cells_per_core / 1e6:.2g} M cells per core, {key['machine']}"


def headline_rows(frame):
    """Rows whose meshes verified: the only ones that may give a number of a table or figure."""
    if frame.empty:
        return frame
    rows = frame[frame["verified"] & frame["cores"].notna()].copy()
    for name in [*KEY, "algorithm"]:
        rows[name] = rows[name].fillna("") if name in rows else ""
    rows["cores"] = rows["cores"].astype(int)
    return rows


def weak_series(frame):
    """All series that have a run of PODM on one core, the one to show first: of most core counts, then the newest."""
    found = []
    rows = headline_rows(frame)
    if rows.empty:
        return found
    for values, group in rows.groupby(KEY, sort=False):
        alone = group[(group["algorithm"] == "podm") & (group["cores"] == 1)]
        for base in _clusters(alone["cells"]):
            members = group[abs(group["cells"] / group["cores"] / base - 1) <= WEAK_TOLERANCE]
            series = Series(dict(zip(KEY, values)), base, _table(members))
            found.append((len(series.table), members.index.max(), series))
    return [series for *_, series in sorted(found, key=lambda entry: entry[:2], reverse=True)]


def first_of(series, basis):
    """The series of that basis to show, or None."""
    return next((one for one in series if one.key["basis"] == basis), None)


def _clusters(cells):
    """Medians of groups of sizes that lie within the tolerance of the smallest of the group."""
    rest = numpy.sort(cells.to_numpy(dtype=float))
    while rest.size:
        near = rest <= rest[0] * (1 + WEAK_TOLERANCE)
        yield float(numpy.median(rest[near]))
        rest = rest[~near]


def _table(members):
    rate = members["cells"] / members["seconds"]
    base = rate[(members["algorithm"] == "podm") & (members["cores"] == 1)]
    lines = {}
    for (algorithm, cores), group in members.groupby(["algorithm", "cores"]):
        line = {"n": len(group), "cells": group["cells"].median()}
        line.update(_bounds("seconds", median_interval(group["seconds"])))
        line.update(_bounds("rate", median_interval(rate[group.index])))
        is_base = algorithm == "podm" and cores == 1
        speedup = (1.0, numpy.nan, numpy.nan) if is_base else ratio_interval(rate[group.index], base)
        line.update(_bounds("speedup", speedup))
        line.update(_bounds("efficiency", [value / cores for value in speedup]))
        for phase in PHASES:
            name = f"phases_s.{phase}"
            line[phase] = group[name].fillna(0).median() if name in group else 0.0
        lines[algorithm, cores] = line
    table = pandas.DataFrame.from_dict(lines, orient="index")
    table.index = pandas.MultiIndex.from_tuples(table.index, names=["algorithm", "cores"])
    return table


def _bounds(name, values):
    return dict(zip((name, name + "_low", name + "_high"), values))
