"""Weak-scaling series: verified rows of one machine, program and input whose cells grow in step with the cores.

Speed-up follows equation 1 of the paper: cells per second over those of PODM on one core; efficiency is speed-up
over cores. Seconds are all phases but `write`.
"""
import math
from dataclasses import dataclass
from pathlib import Path

import numpy
import pandas

from .spread import median_interval, ratio_interval

KEY = ["basis", "machine", "build", "experiment", "input.path"]
# Cells per core may stray this far from one core's; the paper's own stray by 3 %, --target-elements by 5 %.
WEAK_TOLERANCE = 0.10
PAPER_CELLS_PER_CORE = 3e6
PHASES = ["read", "transform", "octree", "initial", "refine", "extract", "other"]


@dataclass(frozen=True)
class Series:
    """`key`: values of KEY by name. `table`: indexed by (algorithm, cores), medians with their bounds and n."""

    key: dict
    cells_per_core: float
    table: pandas.DataFrame

    def label(self):
        key = self.key
        size = f"{self.cells_per_core / 1e6:.2g} M cells per core"
        return ", ".join(part for part in (key["experiment"], Path(key["input.path"]).name, size, key["machine"]) if part)


def headline_rows(frame):
    """The only rows that may give a number of a table or figure: `doubt_of` of load.py finds nothing."""
    if frame.empty:
        return frame
    rows = frame[frame["headline"] & frame["cores"].notna()].copy()
    for name in [*KEY, "algorithm"]:
        rows[name] = rows[name].fillna("") if name in rows else ""
    rows["cores"] = rows["cores"].astype(int)
    return rows


def weak_series(frame):
    """All series that have a run of PODM on one core. First comes the one to show: of most core counts, then nearest to
    the paper's cells per core, then the newest."""
    found = []
    rows = headline_rows(frame)
    if rows.empty:
        return found
    for values, group in rows.groupby(KEY, sort=False):
        alone = group[(group["algorithm"] == "podm") & (group["cores"] == 1)]
        for base in _clusters(alone["cells"]):
            members = group[abs(group["cells"] / group["cores"] / base - 1) <= WEAK_TOLERANCE]
            series = Series(dict(zip(KEY, values)), base, _table(members))
            found.append((len(series.table), -_octaves_from_paper(base), members.index.max(), series))
    return [series for *_, series in sorted(found, key=lambda entry: entry[:3], reverse=True)]


def first_of(series, basis):
    """The series of that basis to show, or None."""
    return next((one for one in series if one.key["basis"] == basis), None)


def shown_of(series):
    """The series to show: one of each basis that there is."""
    return [one for one in (first_of(series, basis) for basis in ("measured", "simulated")) if one is not None]


def core_counts(tables):
    """All numbers of cores in tables indexed by (algorithm, cores), sorted."""
    return sorted({int(cores) for table in tables for cores in table.index.get_level_values("cores")})


def _octaves_from_paper(cells_per_core):
    return round(abs(math.log2(cells_per_core / PAPER_CELLS_PER_CORE)))


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
        line.update(_phases(group))
        lines[algorithm, cores] = line
    table = pandas.DataFrame.from_dict(lines, orient="index")
    table.index = pandas.MultiIndex.from_tuples(table.index, names=["algorithm", "cores"])
    return table


def _phases(group):
    """Median seconds of each phase; `other` is what the phases known here leave of the whole."""
    columns = {f"phases_s.{phase}": phase for phase in PHASES[:-1]}
    phases = group.reindex(columns=columns).rename(columns=columns).astype(float).fillna(0.0)
    phases["other"] = (group["seconds"] - phases.sum(axis=1)).clip(lower=0)
    return phases.median()


def _bounds(name, values):
    return dict(zip((name, name + "_low", name + "_high"), values))
