"""Table 1: weak scaling. Published and measured values in separate lines of one table, simulated ones in a table of
their own."""
import pandas

from . import paper, scaling

VALUES = ["cells", "seconds", "rate", "speedup", "efficiency", "refining_rate", "refining_efficiency"]
BOUNDS = [f"{value}_{end}" for value in VALUES[1:] for end in ("low", "high")]
COLUMNS = ["basis", "cores", "algorithm", "images", "n", *VALUES, *BOUNDS, "series"]
SCALES = {"cells": (1e-6, 2), "seconds": (1, 2), "rate": (1e-6, 2), "speedup": (1, 2), "efficiency": (100, 1),
          "refining_efficiency": (100, 1)}
TITLES = {"cells": "M elements", "seconds": "seconds", "rate": "M elements/s", "speedup": "speed-up",
          "efficiency": "efficiency %", "refining_efficiency": "refining, efficiency %"}
SIMULATED_TITLES = {"cells": "M elements", "seconds": "simulated seconds", "rate": "M elements per simulated second",
                    "speedup": "simulated speed-up", "efficiency": "simulated efficiency %"}


def table1(series):
    """One line a number of cores, algorithm and image: the paper's and the measured. Published values tell no `n`."""
    published = paper.table1().reset_index().assign(basis="published", n=pandas.NA, images="one",
                                                    series="Table 1 of the paper")
    return _joined([published, *_blocks(series, "measured")])


def table1_simulated(series):
    """The like of simulated rows; empty without any."""
    return _joined(_blocks(series, "simulated"))


def _blocks(series, basis):
    return [one.table.reset_index().assign(basis=basis, series=one.label(), images="growing" if one.grows else "one")
            for one in scaling.shown_of(series, [basis])]


def _joined(blocks):
    if not blocks:
        return pandas.DataFrame(columns=COLUMNS)
    table = pandas.concat(blocks, ignore_index=True).astype({"n": "Int64"})
    return in_order(table.reindex(columns=COLUMNS))


def in_order(table):
    """Rows are ordered by cores, then as people compare: PODM first, the published value before ours."""
    peers = sorted(set(table["algorithm"]) - set(paper.ALGORITHMS))
    ranks = {"basis": ["published", "measured", "simulated"], "algorithm": [*paper.ALGORITHMS, *peers],
             "images": ["one", "growing"]}

    def rank(column):
        return column.map(ranks[column.name].index, na_action="ignore") if column.name in ranks else column

    order = [name for name in ("cores", "algorithm", "images", "basis") if name in table]
    return table.sort_values(order, ignore_index=True, key=rank)


def readable(table):
    """The number as the paper prints it: millions, two digits; an interval in brackets where there is one."""
    is_simulated = set(table["basis"]) == {"simulated"}
    shown = table[["cores", "algorithm", "basis", "images", "n"]].copy()
    for name, title in (SIMULATED_TITLES if is_simulated else TITLES).items():
        scale, digits = SCALES[name]
        bounds = [table.get(name + end, pandas.Series(index=table.index, dtype=float)) for end in ("_low", "_high")]
        shown[title] = [with_bounds(*(number * scale for number in numbers), digits)
                        for numbers in zip(table[name], *bounds)]
    return shown


def with_bounds(value, low, high, digits):
    """"1.23 [1.20, 1.26]"; empty without a value."""
    if pandas.isna(value):
        return ""
    bounds = "" if pandas.isna(low) else f" [{low:.{digits}f}, {high:.{digits}f}]"
    return f"{value:.{digits}f}{bounds}"
