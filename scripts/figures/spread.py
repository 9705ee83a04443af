"""Medians and intervals of them by order statistics: no distribution is assumed, and the coverage is exact."""
import math

import numpy

LEVEL = 0.95


def order_interval(values):
    """(low, high, coverage): the narrowest pair of order statistics, as many from each end, that holds the median of
    what the values are drawn from with at least LEVEL. Too few values give the widest pair, whose coverage is less."""
    values = sorted(values)
    number = len(values)
    if number < 2:
        return numpy.nan, numpy.nan, numpy.nan
    tails = numpy.cumsum([math.comb(number, below) / 2**number for below in range(number // 2)])
    coverages = 1 - 2 * tails  # of the pair that leaves so many values out on each side
    left_out = max((place for place, coverage in enumerate(coverages) if coverage >= LEVEL), default=0)
    return values[left_out], values[-1 - left_out], float(coverages[left_out])


def median_interval(values):
    """(median, low, high); low and high are nan for fewer than two values, all three for none."""
    low, high, _ = order_interval(values)
    return float(numpy.median(values)) if len(values) else numpy.nan, low, high
