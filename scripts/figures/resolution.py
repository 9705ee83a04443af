"""Whether a number agrees with a published one, as far as its interval resolves it."""
import math
from dataclasses import dataclass

from .spread import LEVEL, order_interval

AGREES, DIFFERS, NOT_RESOLVED = "agrees", "differs", "not_resolved"


@dataclass(frozen=True)
class Interval:
    """Holds the median of what was measured with the probability `coverage`; nan where one value has no interval."""

    low: float
    high: float
    coverage: float

    def over(self, other):
        """Of this number over another; the lesser coverage."""
        ends = sorted((self.low / other.high, self.high / other.low))
        return Interval(*ends, min(self.coverage, other.coverage))

    def map(self, function):
        """Of a monotone function of the number."""
        return Interval(*sorted((function(self.low), function(self.high))), self.coverage)


EXACT = None  # the interval of what is the same in each run


def of_values(values):
    return Interval(*order_interval(values))


def of_line(line, name, basis):
    """The interval of a line's speed-up or what follows from it; only what is measured varies."""
    if basis != "measured":
        return EXACT
    return Interval(line[f"{name}_low"], line[f"{name}_high"], line["coverage"])


def verdict(value, interval, least=-math.inf, most=math.inf):
    """By the value where it is the same in each run; else by its interval, which has to lie on one side of each
    bound and to have the coverage LEVEL."""
    if interval is EXACT:
        return AGREES if least <= value <= most else DIFFERS
    if not interval.coverage >= LEVEL:  # nor where it is nan
        return NOT_RESOLVED
    if least <= interval.low and interval.high <= most:
        return AGREES
    return DIFFERS if interval.high < least or interval.low > most else NOT_RESOLVED


def together(verdicts):
    """Of several that all have to agree: one that differs decides, one that is not resolved leaves it open."""
    return next((word for word in (DIFFERS, NOT_RESOLVED) if word in verdicts), AGREES)


def doubt(interval):
    """Why it is not resolved, in words to put behind a reason."""
    if interval is EXACT:
        return ""
    if not interval.coverage >= LEVEL:
        return f"; too few rounds for {100 * LEVEL:.0f} %"
    return f"; {interval.low:.3g} to {interval.high:.3g} straddles the bound"
