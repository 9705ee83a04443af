"""Decides whether a number agrees with a published number, as far as its interval resolves it."""
import math
from dataclasses import dataclass

from .spread import LEVEL, order_interval

AGREES, DIFFERS, NOT_RESOLVED = "agrees", "differs", "not_resolved"


@dataclass(frozen=True)
class Interval:
    """Holds the median of the measured values with the probability `coverage`; nan if one value has no interval."""

    low: float
    high: float
    coverage: float

    def over(self, other):
        """Returns the interval of this number over another, with the lesser coverage."""
        ends = sorted((self.low / other.high, self.high / other.low))
        return Interval(*ends, min(self.coverage, other.coverage))

    def map(self, function):
        """Returns the interval of a monotone function of the number."""
        return Interval(*sorted((function(self.low), function(self.high))), self.coverage)


EXACT = None  # the interval of a value that is the same in each run


def of_values(values):
    return Interval(*order_interval(values))


def of_line(line, name, basis):
    """Returns the interval of a line's speed-up or a value that follows from it. Only measured values vary."""
    if basis != "measured":
        return EXACT
    return Interval(line[f"{name}_low"], line[f"{name}_high"], line["coverage"])


def verdict(value, interval, least=-math.inf, most=math.inf):
    """Judges by the value if it is the same in each run. Otherwise judges by the interval, which must lie on one side
    of each bound and have a coverage of at least LEVEL."""
    if interval is EXACT:
        return AGREES if least <= value <= most else DIFFERS
    if not interval.coverage >= LEVEL:  # also for nan
        return NOT_RESOLVED
    if least <= interval.low and interval.high <= most:
        return AGREES
    return DIFFERS if interval.high < least or interval.low > most else NOT_RESOLVED


def together(verdicts):
    """Combines verdicts that all must agree: one that differs decides, one that is not resolved leaves the result
    open."""
    return next((word for word in (DIFFERS, NOT_RESOLVED) if word in verdicts), AGREES)


def doubt(interval):
    """Returns the reason why the number is not resolved, as text to append to a reason."""
    if interval is EXACT:
        return ""
    if not interval.coverage >= LEVEL:
        return f"; too few rounds for {100 * LEVEL:.0f} %"
    return f"; {interval.low:.3g} to {interval.high:.3g} straddles the bound"
