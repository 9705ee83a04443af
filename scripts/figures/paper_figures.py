"""Our figures in the table of the paper's claims: a query, NAME ARGUMENT..., on rows of one basis returns a text.

Each text states the number of cores and, in brackets, the cells per core. A simulated figure lists all sizes.
"""
import inspect
from dataclasses import dataclass
from functools import cached_property

import pandas

from . import claims, scaling, table2, table3
from .reasons import of_basis

WEAK = {"measured": "weak_scaling", "simulated": "simulated_weak"}


class QueryError(Exception):
    """A query that names no figure, or has wrong arguments."""


@dataclass
class Ours:
    """Rows of one basis. `values`: values of claims by name."""

    frame: pandas.DataFrame
    basis: str
    values: dict

    def of(self, experiment):
        """Returns the rows of the experiment that made a mesh in their turn, whatever the verifier's verdict."""
        if not {"basis", "experiment", "cells", "warmup"} <= set(self.frame.columns):
            return self.frame.iloc[:0]
        rows = self.frame[(self.frame["basis"] == self.basis) & (self.frame["experiment"] == experiment)]
        return rows[rows["cells"].notna() & ~rows["warmup"].astype(bool)]

    @cached_property
    def weak(self):
        """Rows of weak scaling that may give a number."""
        return scaling.headline_rows(self.of(WEAK[self.basis]))

    @cached_property
    def sizes(self):
        """Series of weak scaling by cells per core, fewest first; if measured, only the series to show."""
        found = [one for one in scaling.weak_series(self.weak) if one.key["basis"] == self.basis and not one.grows]
        if self.basis == "measured":
            return found[:1]
        by_size = {scaling.short(one.cells_per_core): one for one in found[::-1]}
        return sorted(by_size.values(), key=lambda one: one.cells_per_core)

    def rows_at(self, size, algorithm, cores):
        rows = scaling.rows_of(self.weak, size)
        return rows[(rows["algorithm"] == algorithm) & (rows["cores"] == cores)]


def figure(query, ours):
    """Returns the figure's text; None if no row has its values."""
    name, *arguments = query.split()
    if name not in FIGURES:
        raise QueryError(f"no figure is called {name!r}; known figures: {', '.join(FIGURES)}")
    try:
        inspect.signature(FIGURES[name]).bind(ours, *arguments)
    except TypeError as error:
        raise QueryError(f"{query!r}: {name}: {error}") from None
    return FIGURES[name](ours, *arguments)


def rounded(value):
    """Returns whole numbers from 10 on, three digits below."""
    return f"{value:.0f}" if abs(value) >= 10 else f"{value:.3g}"


def percent(value):
    return f"{100 * value:.2g} %" if value < 0.1 else f"{100 * value:.1f} %"


def by_size(ours, cores, value_of, write=rounded):
    """Returns the text of `value_of` (size, cores) for each size, with its cells per core in brackets. `value_of`
    returns None for a missing value. If `cores` is empty, all numbers of cores beyond one are used."""
    counts = [int(count) for count in cores] or [
        count for count in scaling.core_counts([one.table for one in ours.sizes]) if count > 1]
    found = [(size, [value_of(size, count) for count in counts]) for size in ours.sizes]
    texts = [", ".join("-" if value is None else write(value) for value in values) + in_brackets(size.cells_per_core)
             for size, values in found if any(value is not None for value in values)]
    joint = ", " if len(counts) == 1 else "; "
    return f"{joint.join(texts)} on {', '.join(map(str, counts))} cores" if texts else None


def in_brackets(cells_per_core):
    return f" ({scaling.short(cells_per_core)})"


def speedups(ours, algorithm, *cores):
    """Cells per second over those of PODM on one core, equation 1."""
    return by_size(ours, cores, lambda size, count: _of_table(size, algorithm, count, "speedup"))


def _of_table(size, algorithm, count, column):
    return size.table.loc[(algorithm, count), column] if (algorithm, count) in size.table.index else None


def crossover(ours):
    """The numbers of cores between which PDR.PODM overtakes."""
    found = [(in_brackets(size.cells_per_core), *claims.crossover(size.table)) for size in ours.sizes]
    words = [f"{behind} and {ahead}{size}" for size, behind, ahead in found if behind and ahead]
    return f"between {', '.join(words)} cores" if words else None


def _medians(ours, algorithm, of_rows):
    """Returns a function of (size, count): the median of `of_rows` of their rows, or None without rows."""
    def value_of(size, count):
        rows = ours.rows_at(size, algorithm, count)
        values = of_rows(rows).dropna() if len(rows) else rows
        return float(values.median()) if len(values) else None

    return value_of


def _refining(rows):
    """Seconds per cell of refinement and the phases before it, virtual or of the clock."""
    seconds = rows["virtual.refine_s"] if rows["basis"].iloc[0] == "simulated" else rows["refining_s"]
    return seconds / rows["cells"]


def _worker_seconds(rows, is_counted):
    prefix = "virtual.worker_s."
    names = [name for name in rows if name.startswith(prefix) and is_counted(name.removeprefix(prefix))]
    return rows[names].sum(axis=1, min_count=1)


def _is_distributing(cause):
    """True for the causes that the measure `distributing_share` counts (harness/rows/measures_of_ranks.cpp)."""
    return cause in ("between_attempts", "locks")


def _pdr_over_podm(ours, of_rows):
    pdr, podm = (_medians(ours, algorithm, of_rows) for algorithm in ("pdr-podm", "podm"))

    def value_of(size, count):
        above, below = pdr(size, count), podm(size, count)
        return above / below if above and below else None

    return value_of


def meshing_ratio(ours, *cores):
    """Meshing seconds per cell of PDR.PODM over PODM's."""
    return by_size(ours, cores, _pdr_over_podm(ours, _refining), "{:.2f}".format)


def part(ours, phases, *cores):
    """Phases of PDR.PODM, joined by +, over its seconds of equation 1."""
    names = [f"virtual.phases_s.{phase}" for phase in phases.split("+")]
    of_rows = _medians(ours, "pdr-podm", lambda rows: rows.reindex(columns=names).sum(axis=1) / rows["seconds"])
    return by_size(ours, cores, of_rows, percent)


def distributing(ours, *cores):
    """PDR.PODM's worker seconds for lists, gifts, leaves and their queue over all worker seconds."""
    of_rows = _medians(ours, "pdr-podm", lambda rows: _worker_seconds(rows, _is_distributing)
                       / _worker_seconds(rows, lambda cause: True))
    return by_size(ours, cores, of_rows, percent)


def undistributing_ratio(ours, *cores):
    """All other worker seconds per cell, PDR.PODM's over PODM's."""
    of_rows = _pdr_over_podm(ours, lambda rows: _worker_seconds(rows, lambda cause: not _is_distributing(cause))
                             / rows["cells"])
    return by_size(ours, cores, of_rows, "{:.2f}".format)


def zero_hops(ours, *cores):
    """Percent of PDR.PODM's accesses that take no hop."""
    def of_rows(rows):
        shares = rows["hops"].map(table2.zero_hop_share) if "hops" in rows else pandas.Series(dtype=float)
        return pandas.to_numeric(shares, errors="coerce")

    return by_size(ours, cores, _medians(ours, "pdr-podm", of_rows), lambda share: f"{100 * share:.2f} %")


def latencies(ours):
    """Cycles by level of memory on the present machine."""
    costs = table3.costs(of_basis(ours.frame, ours.basis))
    costs = costs[costs["cycles"].notna()]
    own = f"{', '.join(costs.loc[~costs['is_another'], 'text'])} cycles, the last from memory" if len(costs) else None
    others = costs.loc[costs["is_another"], "text"]
    return f"{own}; {', '.join(others)} from other nodes'" if len(others) else own


def initial_cores(ours):
    """Cells per second by the number of cores that make the initial mesh, for the largest mesh."""
    rows = scaling.headline_rows(ours.of("simulated_initial_mesh"))
    if rows.empty:
        return None
    rows = rows[rows["cells"] >= 0.9 * rows["cells"].max()]
    rates = (rows["cells"] / rows["seconds"]).groupby(rows["asked.initial_threads"]).median() / 1e6
    cores = int(rows["cores"].max())
    values, counts = (", ".join(map(form.format, numbers)) for form, numbers in (("{:.2f}", rates),
                                                                               ("{:.0f}", rates.index)))
    return f"{values} M per second{in_brackets(rows['cells'].median() / cores)} with {counts} of {cores} cores for it"


def _proved(rows, claim):
    """Returns (number of rows that passed, number of rows asked)."""
    name = f"verdicts.{claim}"
    asked = rows[name].dropna() if name in rows else []
    return sum(asked == "pass") if len(asked) else 0, len(asked)


def kept_apart(ours):
    rows = ours.of("buffer_zones")
    passed, asked = _proved(rows, "conformity")
    return f"conformity proved of {passed} of {asked} schedules and meshes {_extent(rows)}" if asked else None


def shapes(ours):
    """The worst values of all meshes of the experiment on quality."""
    rows = ours.of("quality")
    names = ["quality.max_radius_edge", "quality.min_facet_angle_deg"]
    if rows.empty or not set(names) <= set(rows.columns):
        return None
    ratio, angle = rows[names[0]].max(), rows[names[1]].min()
    return f"{len(rows)} meshes {_extent(rows)}: ratios up to {ratio:.7g}, angles from {angle:.7g} degrees"


def proofs(ours, claim):
    passed, asked = _proved(ours.of("quality"), claim)
    return f"{claim} proved of {passed} of {asked} that were checked" if asked else None


def topology(ours):
    """For the meshes that were asked for fidelity: labels with the image's components, and with its Euler number."""
    rows = ours.of("quality")
    names = ["topology.labels", "topology.components_as_image", "topology.euler_as_image"]
    if rows.empty or not {*names, "asked.fidelity"} <= set(rows.columns):
        return None
    labels, components, euler = rows.loc[rows["asked.fidelity"] == True, names].sum()  # noqa: E712  (or missing)
    return f"{components:.0f} of {labels:.0f} labels have the image's components, {euler:.0f} its Euler number"


def waiting_by_leaf_size(ours):
    """Share of waiting by side of the leaves, for the largest mesh."""
    rows = scaling.headline_rows(ours.of("simulated_leaf_size"))
    if rows.empty:
        return None
    rows = rows[rows["cells"] >= 0.9 * rows["cells"].max()]
    waiting = _worker_seconds(rows, "begging".__eq__) / _worker_seconds(rows, lambda cause: True)
    shares = waiting.groupby(rows["asked.leaf_size"]).median()
    cores = int(rows["cores"].max())
    return (f"{', '.join(map(percent, shares))} of worker time is waiting{in_brackets(rows['cells'].median() / cores)} "
            f"with leaves of {', '.join(f'{side:g}' for side in shares.index)} mm on {cores} cores")


def one_core(ours, algorithm):
    """Cells per second of the largest mesh on one core."""
    rows = scaling.headline_rows(ours.of("single_core"))
    rows = rows[rows["algorithm"] == algorithm] if len(rows) else rows
    if rows.empty:
        return None
    rows = rows[rows["cells"] >= 0.9 * rows["cells"].max()]
    rate = (rows["cells"] / rows["seconds"]).median() / 1e6
    return f"{rate:.2f} M per second{in_brackets(rows['cells'].median())}"


def size(ours, experiment, cores=None):
    """Cores and cells per core of an experiment; if `cores` is given, only of its rows on this number of cores."""
    rows = ours.of(experiment)
    if len(rows) and cores:
        rows = rows[rows["cores"] == int(cores)]
    return _extent(rows) if len(rows) else None


def _extent(rows):
    most = int(rows["cores"].max())
    return (f"on {'up to ' if most > 1 else ''}{most} core{'s' if most > 1 else ''}"
            f"{in_brackets((rows['cells'] / rows['cores']).max())}")


def value(ours, claim):
    """podm-bench's value of a claim: that of the group nearest to breaking it."""
    found = ours.values.get(claim)
    return None if found is None else f"{found:.2f}"


FIGURES = {one.__name__: one for one in (
    speedups, crossover, meshing_ratio, part, distributing, undistributing_ratio, zero_hops, latencies, initial_cores,
    kept_apart, shapes, proofs, topology, waiting_by_leaf_size, one_core, size, value)}
