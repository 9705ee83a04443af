"""What a simulated quantity would be of the paper's cells a core.

What cores do to each other happens along the borders between their parts of the mesh, a share of its cells that falls
as surface over volume: quantities are lines in (cells a core)^(-1/3), fitted by least squares to the sizes simulated.
"""
import numpy

PAPER_CELLS_PER_CORE = 3e6
# Of fewer a core leaves are too few for the nodes to work at one time: nothing is extrapolated from such sizes.
LEAST_CELLS_PER_CORE = 30e3


def at_paper_size(sizes, values):
    """(value, low, high) from a value at each number of cells a core. The bounds are the least and the greatest of the
    line through all and of those that leave one size out: nan of two sizes, which leave none out; all nan of fewer."""
    sizes, values = numpy.asarray(sizes, dtype=float), numpy.asarray(values, dtype=float)
    if len(sizes) < 2:
        return numpy.nan, numpy.nan, numpy.nan
    value = _line_at_paper_size(sizes, values)
    if len(sizes) == 2:
        return value, numpy.nan, numpy.nan
    others = [_line_at_paper_size(numpy.delete(sizes, left_out), numpy.delete(values, left_out))
              for left_out in range(len(sizes))]
    return value, min(value, *others), max(value, *others)


def _line_at_paper_size(sizes, values):
    slope, intercept = numpy.polyfit(sizes ** (-1 / 3), values, 1)
    return float(intercept + slope * PAPER_CELLS_PER_CORE ** (-1 / 3))
