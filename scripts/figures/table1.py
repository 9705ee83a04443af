"""Table 1: weak scaling. Published, measured and simulated values are separate lines of one table. Numbers that were
not measured by a clock have a mark."""
import pandas

from . import paper, scaling, style

VALUES = ["cells", "seconds", "rate", "speedup", "efficiency", "refining_rate", "refining_efficiency"]
BOUNDS = [f"{value}_{end}" for value in VALUES[1:] for end in ("low", "high")]
COLUMNS = ["basis", "kind", "cores", "algorithm", "images", "n", *VALUES, *BOUNDS, "series"]
SCALES = {"cells": (1e-6, 2), "seconds": (1, 2), "rate": (1e-6, 2), "speedup": (1, 2), "efficiency": (100, 1),
          "refining_efficiency": (100, 1)}
TITLES = {"cells": "M elements", "seconds": "seconds", "rate": "M elements/s", "speedup": "speed-up",
          "efficiency": "efficiency %", "refining_efficiency": "refining, efficiency %"}
# Put before numbers of virtual workers: hollow, as their markers in figures.
MARKS = {"simulated": "\N{WHITE CIRCLE} "}


def table1(series):
    """One line per number of cores, algorithm, basis and image. Published values have no `n`."""
    published = paper.table1().reset_index().assign(basis="published", kind="published", n=pandas.NA, images="one",
                                                    series="Table 1 of the paper")
    ours = [one.table.reset_index().assign(basis=one.key["basis"], kind=one.kind(), series=one.label(),
                                           images="growing" if one.grows else "one")
            for one in scaling.shown_of(series)]
    table = pandas.concat([published, *ours], ignore_index=True).astype({"n": "Int64"})
    return in_order(table.reindex(columns=COLUMNS))


def in_order(table):
    """Orders rows by cores, then for comparison: PODM first, the published value before ours."""
    others = sorted(set(table["algorithm"]) - set(style.NAMES))
    ranks = {"basis": ["published", *scaling.BASES], "algorithm": [*style.NAMES, *others],
             "images": ["one", "growing"]}

    def rank(column):
        return column.map(ranks[column.name].index, na_action="ignore") if column.name in ranks else column

    order = [name for name in ("cores", "algorithm", "images", "basis") if name in table]
    return table.sort_values(order, ignore_index=True, key=rank)


def readable(table):
    """Formats numbers as in the paper: millions, two digits. Adds the interval in brackets, if any, and the mark of the
    basis."""
    shown = table[["cores", "algorithm", "kind", "images", "n"]].rename(columns={"kind": "basis"})
    for name, title in TITLES.items():
        scale, digits = SCALES[name]
        bounds = [table.get(name + end, pandas.Series(index=table.index, dtype=float)) for end in ("_low", "_high")]
        shown[title] = [marked(with_bounds(*(number * scale for number in numbers), digits), basis)
                        for basis, *numbers in zip(table["basis"], table[name], *bounds)]
    return shown


def marked(text, basis):
    """Returns a number with the mark of its basis."""
    return MARKS.get(basis, "") + text if text else ""


def with_bounds(value, low, high, digits):
    """Returns "1.23 [1.20, 1.26]"; empty without a value."""
    if pandas.isna(value):
        return ""
    bounds = "" if pandas.isna(low) else f" [{low:.{digits}f}, {high:.{digits}f}]"
    return f"{value:.{digits}f}{bounds}"
