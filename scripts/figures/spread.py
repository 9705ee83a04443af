"""Medians and their intervals by order statistics. No distribution is assumed, and the coverage is exact."""
import math

import numpy

LEVEL = 0.95


def order_interval(values):
    """Returns (low, high, coverage): the narrowest symmetric pair of order statistics that holds the median of the
    distribution with at least LEVEL. Too few values give the widest pair, whose coverage is below LEVEL."""
    values = sorted(values)
    number = len(values)
    if number < 2:
        return numpy.nan, numpy.nan, numpy.nan
    tails = numpy.cumsum([math.comb(number, below) / 2**number for below in range(number // 2)])
    coverages = 1 - 2 * tails  # of the pairs by number of values left out on each side
    left_out = max((place for place, coverage in enumerate(coverages) if coverage >= LEVEL), default=0)
    return values[left_out], values[-1 - left_out], float(coverages[left_out])


def median_interval(values):
    """Returns (median, low, high). Low and high are nan for fewer than two values, all three are nan without values."""
    low, high, _ = order_interval(values)
    return float(numpy.median(values)) if len(values) else numpy.nan, low, high
