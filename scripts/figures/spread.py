"""Median and percentile-bootstrap interval, with a fixed seed: equal records give equal figures."""
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
