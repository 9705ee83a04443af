"""Extrapolates from simulated ranks of few cells to nodes of 20 million, with a model of each part of the time, fitted
over sizes.

At each number of ranks, each part of the microseconds per cell of a rank is a sum of four terms, none of them negative:
one for the cells (1), one for the surface of a rank's share (cells^(-1/3)), along which round 0 defers, one for its
edges (cells^(-2/3)), along which later rounds defer, and one for costs that occur once per rank (1 / cells). The parts
of one rank, whose sum is the base, are fitted in the same way.
"""
import numpy
import pandas
from scipy.optimize import nnls

from . import scaling
from .distributed import PARTS, REFINING

NODE_CELLS = 20e6
LEAST_SIZES = 3
LEAST_CELLS_PER_RANK = 100e3  # with fewer cells most cells lie along the borders of blocks
NODES = (8, 64)
THREADS = (1, 16)
TERMS = {"volume": lambda n: numpy.ones_like(n), "surface": lambda n: n ** (-1 / 3), "edges": lambda n: n ** (-2 / 3),
         "once": lambda n: 1 / n}
# The terms of each part. The image does not depend on the size.
MODEL = {"transform": ("once",), "initial": ("volume", "surface"), "learn": ("volume", "surface"),
         "refine": ("volume", "surface"), "later": ("surface", "edges"), "exchange": ("volume", "surface"),
         "waiting": ("volume", "surface", "edges"), "network": ("surface", "once"), "extract": ("volume", "surface")}
# The other parts run on one thread today, whatever the number of threads of a node.
THREADED = ("transform", "initial", "refine", "later", "waiting", "extract")
REFINING_PARTS = (*REFINING, "learn", "waiting", "network")
COLUMNS = ["basis", "ranks", "threads", "cells_per_rank", "n", "sizes", "refining_efficiency",
           "refining_efficiency_low", "refining_efficiency_high", "efficiency", "efficiency_low", "efficiency_high",
           "worst_miss", *PARTS]
ASSUMPTIONS = (
    "Extrapolated: to nodes of 20 million cells, part by part, from the simulated sizes, as a sum of parts that grow "
    "with the cells, with the surface of a rank's share (cells^(-1/3)), its edges (cells^(-2/3)) and once; bars: the "
    "range when any one of the sizes is left out, no confidence interval. It is assumed that the coarse mesh, of "
    "the ratio simulated, is made by all threads of the first node while the others wait, and learned by one of each; "
    "that sixteen threads of a node share rounds, pieces and waiting alike, with and without ranks, and leave updates "
    "to one; that nodes are as fast as the processor that simulated them, all the same, and the network as stated, "
    "without congestion; that each node holds the image, the same for all sizes")


def extrapolated(table):
    """One line per number of nodes and threads per node with three simulated sizes or more. With two sizes nothing
    would be left to check the model. `worst_miss`: each size is predicted from the other sizes; the greatest relative
    error in microseconds per cell."""
    simulated = table[(table["basis"] == "simulated") & (table["cells_per_rank"] >= LEAST_CELLS_PER_RANK)]
    by_size = simulated.fillna({part: 0.0 for part in PARTS}).set_index("cells_per_rank")
    base, lines = by_size[by_size["ranks"] == 1], []
    for ranks in NODES:
        many = by_size[by_size["ranks"] == ranks]
        if len(many) >= LEAST_SIZES and len(base) >= LEAST_SIZES:
            lines += [_line(ranks, threads, many, base) for threads in THREADS]
    return pandas.DataFrame(lines, columns=COLUMNS)


def _line(ranks, threads, many, base):
    """A single rank may have been simulated at further sizes."""
    def efficiencies(left_out=()):
        ours, alone = (_parts_at(NODE_CELLS, one.drop(index=left_out, errors="ignore")) for one in (many, base))
        return numpy.array([_sum(alone, parts, threads) / _sum(ours, parts, threads)
                            for parts in (REFINING_PARTS, PARTS)])

    value, sizes = efficiencies(), list(many.index)
    bounds = numpy.array([value, *(efficiencies([size]) for size in sizes)])
    return {"basis": "extrapolated", "ranks": ranks, "threads": threads, "cells_per_rank": NODE_CELLS, "n": len(sizes),
            "sizes": " and ".join(scaling.short(size) for size in sizes),
            **{name + end: number for end, numbers in (("", value), ("_low", bounds.min(0)), ("_high", bounds.max(0)))
               for name, number in zip(("refining_efficiency", "efficiency"), numbers)},
            "worst_miss": _worst_miss(many), **_of_threads(_parts_at(NODE_CELLS, many), threads)}


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


def _of_threads(parts, threads):
    return {part: value / (threads if part in THREADED else 1) for part, value in parts.items()}


def _sum(parts, chosen, threads):
    divided = _of_threads(parts, threads)
    return sum(divided[part] for part in chosen)


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
