"""Extrapolates from simulated ranks of few cells to nodes of 20 million, with a model of each part of the time, fitted
over sizes.

For each number of ranks and of threads per rank, each part of the microseconds per cell of a rank is a sum of at most
two terms, none of them negative: for the cells (1), for the surface of a rank's share (cells^(-1/3)), along which round
0 defers, for its edges (cells^(-2/3)), along which later rounds defer, and for costs that occur once per rank (1 /
cells). The parts of one rank with as many threads, whose sum is the base, are fitted in the same way.
"""
import numpy
import pandas
from scipy.optimize import nnls

from . import scaling
from .distributed import PARTS, REFINING

NODE_CELLS = 20e6
LEAST_SIZES = 3
LEAST_CELLS_PER_RANK = 100e3  # with fewer cells most cells lie along the borders of blocks
NODES = (1, 8, 64)
TERMS = {"volume": lambda n: numpy.ones_like(n), "surface": lambda n: n ** (-1 / 3), "edges": lambda n: n ** (-2 / 3),
         "once": lambda n: 1 / n}
# The terms of each part. The image does not depend on the size. Ranks wait for those with more cells, and for the few
# that have cells in the last rounds.
MODEL = {"transform": ("once",), "initial": ("volume", "surface"), "refine": ("volume", "surface"),
         "later": ("surface", "edges"), "exchange": ("volume", "surface"), "waiting": ("volume", "edges"),
         "network": ("surface", "once"), "extract": ("volume", "surface")}
REFINING_PARTS = (*REFINING, "waiting", "network")
COLUMNS = ["basis", "ranks", "threads", "cells_per_rank", "n", "sizes", "refining_efficiency",
           "refining_efficiency_low", "refining_efficiency_high", "efficiency", "efficiency_low", "efficiency_high",
           "worst_miss", *PARTS]
ASSUMPTIONS = (
    "Extrapolated: to nodes of 20 million cells, part by part, from the simulated sizes, as a sum of parts that grow "
    "with the cells, with the surface of a rank's share (cells^(-1/3)), its edges (cells^(-2/3)) and once; bars: the "
    "range when any one of the sizes is left out, no confidence interval. It is assumed that nodes are as fast as the "
    "processor that simulated them, all the same, that their threads share work as simulated threads do, and the "
    "network as stated, without congestion")


def extrapolated(table):
    """One line per number of nodes and threads per node with three simulated sizes or more, also of one node. With two
    sizes nothing would be left to check the model. `worst_miss`: each size is predicted from the other sizes; the
    greatest relative error in microseconds per cell."""
    simulated = table[(table["basis"] == "simulated") & (table["cells_per_rank"] >= LEAST_CELLS_PER_RANK)]
    lines = []
    for _, same in simulated.fillna({part: 0.0 for part in PARTS}).groupby("threads"):
        by_size = same.set_index("cells_per_rank")
        base = by_size[by_size["ranks"] == 1]
        for ranks in NODES:
            many = by_size[by_size["ranks"] == ranks]
            if len(many) >= LEAST_SIZES and len(base) >= LEAST_SIZES:
                lines.append(_line(many, base))
    return pandas.DataFrame(lines, columns=COLUMNS)


def _line(many, base):
    """A single rank may have been simulated at further sizes."""
    def efficiencies(left_out=()):
        ours, alone = (_parts_at(NODE_CELLS, one.drop(index=left_out, errors="ignore")) for one in (many, base))
        return numpy.array([sum(alone[part] for part in parts) / sum(ours[part] for part in parts)
                            for parts in (REFINING_PARTS, PARTS)])

    value, sizes = efficiencies(), list(many.index)
    bounds = numpy.array([value, *(efficiencies([size]) for size in sizes)])
    return {"basis": "extrapolated", "ranks": many["ranks"].iloc[0], "threads": many["threads"].iloc[0],
            "cells_per_rank": NODE_CELLS, "n": len(sizes), "sizes": _in_words(sizes),
            **{name + end: number for end, numbers in (("", value), ("_low", bounds.min(0)), ("_high", bounds.max(0)))
               for name, number in zip(("refining_efficiency", "efficiency"), numbers)},
            "worst_miss": _worst_miss(many), **_parts_at(NODE_CELLS, many)}


def _in_words(sizes):
    *most, last = (scaling.short(size) for size in sizes)
    return f"{', '.join(most)} and {last}"


def _parts_at(cells, table):
    """Returns the microseconds per cell by part, fitted to the lines of `table`, whose index is the cells per rank."""
    sizes = table.index.to_numpy(dtype=float)
    return {part: _fitted(sizes, table[part].to_numpy(dtype=float), MODEL[part], cells) for part in PARTS}


def _fitted(sizes, values, terms, cells):
    """Minimises the sum of squared errors with coefficients of at least zero."""
    if not values.any():
        return 0.0
    columns = numpy.column_stack([TERMS[term](sizes) for term in terms])
    scales = columns.max(0)
    coefficients, _ = nnls(columns / scales, values)
    return float(sum(one / scale * TERMS[term](numpy.array([cells]))[0]
                     for one, scale, term in zip(coefficients, scales, terms)))


def _worst_miss(many):
    misses = []
    for size in many.index:
        predicted = sum(_parts_at(size, many.drop(index=size)).values())
        misses.append(abs(predicted / many.loc[size, list(PARTS)].sum() - 1))
    return max(misses)


def readable(table):
    def share(line, name):
        return f"{100 * line[name]:.0f} % [{100 * line[name + '_low']:.0f}, {100 * line[name + '_high']:.0f}]"

    shown = table[["ranks", "threads", "sizes"]].rename(columns={"ranks": "nodes", "threads": "threads of a node",
                                                                 "sizes": "from cells per rank"}).copy()
    shown.insert(2, "M cells per node", [f"{1e-6 * cells:.3g}" for cells in table["cells_per_rank"]])
    lines = table.to_dict("records")
    shown["efficiency, refining"] = [share(line, "refining_efficiency") for line in lines]
    shown["efficiency, whole"] = [share(line, "efficiency") for line in lines]
    shown["worst miss of a size left out"] = [f"{100 * one:.0f} %" for one in table["worst_miss"]]
    for part, words in PARTS.items():
        shown[f"{words}, us per cell"] = [f"{value:.3g}" for value in table[part]]
    return shown
