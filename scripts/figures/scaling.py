"""Weak-scaling series: verified rows of one machine, program, trial and image whose cells grow in step with the cores.

Speed-up follows equation 1 of the paper: cells per second over those of PODM on one core; efficiency is speed-up over
cores. Seconds are the phases that load.py times. `refining` counts only the phases that make the mesh. Its efficiency
is the median of ratios to PODM on one core in the same round, so that a machine that becomes slower from round to round
does not affect it.

A series has one of two bases, measured or simulated; no line of a table or figure joins them. The base of a series is a
run with the same number of cells per core; no series uses another's base. There are no values for the paper's cells per
core if these were not run.
"""
import math
from dataclasses import dataclass

import numpy
import pandas

from .spread import median_interval, order_interval

KEY = ["basis", "machine", "build", "experiment", "setting", "image"]
# Cells per core may deviate this much from those on one core. The paper's deviate by 3 %, a radius for a target by 5 %.
SIZE_TOLERANCE = 0.10
BASES = ("measured", "simulated")
PAPER_CELLS_PER_CORE = 3e6
# Keys that simulations of several sizes share. Each size has its own image, NAME@SIZE, with as many voxels per cell.
FAMILY = ["basis", "machine", "build", "experiment"]
PHASES = ["allocate", "read", "transform", "octree", "initial", "refine", "closing", "extract", "other"]


@dataclass(frozen=True)
class Series:
    """`key`: values of KEY by name. `table`: indexed by (algorithm, cores), medians with their bounds and n. `grows`:
    True if each number of cores has its own image."""

    key: dict
    cells_per_core: float
    table: pandas.DataFrame
    grows: bool = False

    def label(self):
        """Returns a description of the trial, the image and the machine."""
        key = self.key
        image = "an image that grows with the cores" if self.grows else key["image"]
        size = f"{short(self.cells_per_core)} cells per core"
        return ", ".join(part for part in (key["experiment"], key["setting"], image, size, key["machine"]) if part)

    def kind(self):
        """Returns the description in legends and tables. The basis is the first word."""
        basis = self.key["basis"]
        size = f", {short(self.cells_per_core)} cells per core" if basis == "simulated" else ""
        return basis + size + (", image grows" if self.grows else "")


def short(cells):
    """Returns two digits: "40 k", "3 M"."""
    scale, unit = (1e3, "k") if cells < 999_500 else (1e6, "M")
    return f"{float(f'{cells / scale:.2g}'):g}\N{NO-BREAK SPACE}{unit}"


def headline_rows(frame):
    """Returns the only rows that may give a number of a table or figure: `doubt_of` of load.py finds no doubt."""
    return with_keys(frame[frame["headline"] & frame["cores"].notna()]) if len(frame) else frame


def with_keys(rows):
    """Returns the rows with every column that groups them, empty if a row lacks it."""
    rows = rows.copy()
    for name in [*KEY, "algorithm"]:
        rows[name] = rows[name].fillna("") if name in rows else ""
    rows["cores"] = rows["cores"].astype(int)
    return rows


def of_one_size(rows):
    """Returns the rows with about as many cells as the newest row. Sizes are never mixed in one number."""
    return rows[abs(rows["cells"] / rows["cells"].iloc[-1] - 1) <= SIZE_TOLERANCE]


def weak_series(frame):
    """Returns all series that have a run of PODM on one core. The series to show comes first: most core counts, then
    nearest to the paper's cells per core, then newest."""
    found = []
    rows = headline_rows(frame)
    if rows.empty:
        return found
    for values, group in rows.groupby(KEY, sort=False):
        alone = group[(group["algorithm"] == "podm") & (group["cores"] == 1)]
        for base in _clusters(alone["cells"]):
            members = group[abs(group["cells"] / group["cores"] / base - 1) <= SIZE_TOLERANCE]
            series = Series(dict(zip(KEY, values)), base, _table(members), bool(members["grows"].iloc[0]))
            found.append((len(series.table), -_octaves_from_paper(base), members.index.max(), series))
    return [series for *_, series in sorted(found, key=lambda entry: entry[:3], reverse=True)]


def rows_of(frame, series):
    rows = headline_rows(frame)
    rows = rows[(rows[list(series.key)] == pandas.Series(series.key)).all(axis=1)]
    return rows[abs(rows["cells"] / rows["cores"] / series.cells_per_core - 1) <= SIZE_TOLERANCE]


def simulated_sizes(series):
    """Returns the simulated series to show and those of its experiment and machine with other cells per core, fewest
    first."""
    shown = first_of(series, "simulated")
    if shown is None:
        return []
    likes = [one for one in series if not one.grows and _family(one) == _family(shown)]
    return sorted({short(one.cells_per_core): one for one in likes[::-1]}.values(), key=lambda one: one.cells_per_core)


def _family(series):
    return [*(series.key[name] for name in FAMILY), series.key["image"].partition("@")[0]]


def first_of(series, basis, grows=False):
    """Returns the series of that basis to show, or None."""
    return next((one for one in series if one.key["basis"] == basis and one.grows == grows), None)


def shown_of(series, bases=BASES):
    """Returns the series to show: for each basis one with the same image for all cores and one with a growing image, as
    far as they exist. One core alone shows no growth."""
    chosen = [first_of(series, basis, grows) for basis in bases for grows in (False, True)]
    return [one for one in chosen if one is not None and not (one.grows and len(core_counts([one.table])) < 2)]


def core_counts(tables):
    """Returns all numbers of cores in tables indexed by (algorithm, cores), sorted."""
    return sorted({int(cores) for table in tables for cores in table.index.get_level_values("cores")})


def _octaves_from_paper(cells_per_core):
    return round(abs(math.log2(cells_per_core / PAPER_CELLS_PER_CORE)))


def _clusters(cells):
    """Yields the medians of groups of sizes within the tolerance of the smallest size of the group."""
    rest = numpy.sort(cells.to_numpy(dtype=float))
    while rest.size:
        near = rest <= rest[0] * (1 + SIZE_TOLERANCE)
        yield float(numpy.median(rest[near]))
        rest = rest[~near]


def _table(members):
    rate, refining_rate = members["cells"] / members["seconds"], members["cells"] / members["refining_s"]
    is_base = (members["algorithm"] == "podm") & (members["cores"] == 1)
    pairs = _pairs(members)
    base_of_pair = refining_rate[is_base].groupby(pairs[is_base]).last()
    lines = {}
    for (algorithm, cores), group in members.groupby(["algorithm", "cores"]):
        line = {"n": len(group), "cells": group["cells"].median()}
        line.update(_bounds("seconds", median_interval(group["seconds"])))
        line.update(_bounds("rate", median_interval(rate[group.index])))
        alone = algorithm == "podm" and cores == 1
        speedup, line["coverage"] = _speedup(rate[group.index], pairs[group.index], rate[is_base], pairs[is_base])
        speedup = (1.0, numpy.nan, numpy.nan) if alone else speedup
        line.update(_bounds("speedup", speedup))
        line.update(_bounds("efficiency", [value / cores for value in speedup]))
        line.update(_bounds("refining_rate", median_interval(refining_rate[group.index])))
        ratios = (refining_rate[group.index] / pairs[group.index].map(base_of_pair) / cores).dropna()
        line.update(_bounds("refining_efficiency", (1.0, numpy.nan, numpy.nan) if alone else median_interval(ratios)))
        line.update(_phases(group))
        lines[algorithm, cores] = line
    return _indexed(lines)


def _pairs(members):
    """Returns the key by which rows are paired for a ratio: for measured rows the round, in which they share
    disturbances; for simulated rows the seed, as no clock disturbs them."""
    key = "seed" if members["basis"].iloc[0] == "simulated" and "seed" in members else "repeat"
    return members.get(key, pandas.Series(index=members.index, dtype=float))


def _speedup(rates, pairs, base_rates, base_pairs):
    """Returns ((speed-up, low, high), coverage): the median of the ratios within pairs. Without common pairs it is the
    ratio of the medians, which has no interval."""
    ratios = (rates / pairs.map(base_rates.groupby(base_pairs).last())).dropna()
    if ratios.empty:
        return (float(rates.median() / base_rates.median()), numpy.nan, numpy.nan), numpy.nan
    return median_interval(ratios), order_interval(ratios)[2]


def _indexed(lines):
    table = pandas.DataFrame.from_dict(lines, orient="index")
    table.index = pandas.MultiIndex.from_tuples(table.index, names=["algorithm", "cores"])
    return table


def _phases(group):
    """Returns the median seconds of each phase; `other` is the rest of the whole."""
    columns = {f"timed.{phase}": phase for phase in PHASES[:-1]}
    phases = group.reindex(columns=columns).rename(columns=columns).astype(float).fillna(0.0)
    phases["other"] = (group["seconds"] - phases.sum(axis=1)).clip(lower=0)
    return phases.median()


def _bounds(name, values):
    return dict(zip((name, name + "_low", name + "_high"), values))
