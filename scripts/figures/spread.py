"""Medians and intervals of them: percentile-bootstrap with a fixed seed, so that equal records give equal figures, and
by order statistics."""
import math

import numpy

DRAWS = 4000
LEVEL = 0.95


def resampled_medians(values):
    """Medians of DRAWS samples drawn from `values` with replacement."""
    values = numpy.asarray(values, dtype=float)
    picks = numpy.random.default_rng(1).integers(len(values), size=(DRAWS, len(values)))
    return numpy.median(values[picks], axis=1)


def interval(samples):
    """The middle LEVEL of bootstrap samples: (low, high)."""
    tail = 50 * (1 - LEVEL)
    return tuple(numpy.percentile(samples, [tail, 100 - tail]))


def median_interval(values):
    """(median, low, high); low and high are nan for fewer than two values, all three for none."""
    if len(values) < 2:
        return float(numpy.median(values)) if len(values) else numpy.nan, numpy.nan, numpy.nan
    return (float(numpy.median(values)), *interval(resampled_medians(values)))


def ratio_interval(values, base):
    """(ratio of medians, low, high); nan bounds where both samples are single."""
    ratio = float(numpy.median(values) / numpy.median(base))
    if len(values) < 2 and len(base) < 2:
        return ratio, numpy.nan, numpy.nan
    above = resampled_medians(values)
    below = numpy.random.default_rng(2).permutation(resampled_medians(base))  # drawn apart from those above
    return (ratio, *interval(above / below))


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
