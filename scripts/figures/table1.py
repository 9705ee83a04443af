"""Table 1: weak scaling. Published, measured and simulated values in separate blocks, never in one series."""
import pandas

from . import paper, scaling

VALUES = ["cells", "seconds", "rate", "speedup", "efficiency"]
BOUNDS = [f"{value}_{end}" for value in VALUES[1:] for end in ("low", "high")]


def table1(series):
    """One line a basis, number of cores and algorithm; the first series of each basis. Published values tell no `n`."""
    blocks = [paper.table1().reset_index().assign(basis="published", n=pandas.NA, series="Table 1 of the paper")]
    for one in scaling.shown_of(series):
        blocks.append(one.table.reset_index().assign(basis=one.key["basis"], series=one.label()))
    table = pandas.concat(blocks, ignore_index=True).astype({"n": "Int64"})
    columns = ["basis", "cores", "algorithm", "n", *VALUES, *BOUNDS, "series"]
    return in_order(table.reindex(columns=columns))


def in_order(table):
    """By cores, then as people compare: PODM first, the published value before ours."""
    peers = sorted(set(table["algorithm"]) - set(paper.ALGORITHMS))
    ranks = {"basis": ["published", "measured", "simulated"], "algorithm": [*paper.ALGORITHMS, *peers]}

    def rank(column):
        return column.map(ranks[column.name].index, na_action="ignore") if column.name in ranks else column

    return table.sort_values(["cores", "algorithm", "basis"], ignore_index=True, key=rank)


def readable(table):
    """As the paper prints it: millions, two digits; an interval in brackets where there is one."""
    scales = {"cells": (1e-6, 2), "seconds": (1, 2), "rate": (1e-6, 2), "speedup": (1, 2), "efficiency": (100, 1)}
    shown = table[["cores", "algorithm", "basis", "n"]].copy()
    titles = {"cells": "M elements", "seconds": "seconds", "rate": "M elements/s", "speedup": "speed-up",
              "efficiency": "efficiency %"}
    for name, (scale, digits) in scales.items():
        low = table.get(name + "_low", pandas.Series(index=table.index, dtype=float))
        high = table.get(name + "_high", pandas.Series(index=table.index, dtype=float))
        shown[titles[name]] = [_with_bounds(*(number * scale for number in numbers), digits)
                               for numbers in zip(table[name], low, high)]
    return shown


def _with_bounds(value, low, high, digits):
    bounds = "" if pandas.isna(low) else f" [{low:.{digits}f}, {high:.{digits}f}]"
    return f"{value:.{digits}f}{bounds}"
