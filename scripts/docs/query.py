"""The query of a figure: SOURCES; FILTER; VALUE; STATISTIC; FORMAT (see scripts/docs/README.md)."""
import re
import statistics
from dataclasses import dataclass

from figures.spread import order_interval

from .condition import Filter, parse_filter
from .errors import DocsError
from .expression import FACT, Expression

WORDS = ("none", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")
INTERVAL = {"low": lambda values: order_interval(values)[0], "high": lambda values: order_interval(values)[1],
            "coverage": lambda values: order_interval(values)[2]}
OF_VALUES = {"median": statistics.median, "mean": statistics.fmean, "min": min, "max": max, "sum": sum, "count": len,
             **INTERVAL}
OF_RATIOS = {"ratio": statistics.median, **{f"ratio-{name}": end for name, end in INTERVAL.items()}}
OF_TWO = (*OF_RATIOS, "ratio-of-medians")
FORMAT = re.compile(r"(?:([*/])\s*([\d.e+-]+)\s+)?(\S+)")


@dataclass(frozen=True)
class Rows:
    """Files and a filter, as named by `<!--rows NAME = ...-->`."""

    names: tuple
    filter: Filter


@dataclass(frozen=True)
class Query:
    """`base`: for a statistic of two sides, the filter of the rows to divide by; otherwise None."""

    rows: Rows
    value: Expression
    statistic: str
    base: Filter | None
    scale: float
    format: str


def parse_rows(text, known):
    """Parses `FILE...; FILTER`, or `NAME; FILTER` for rows that the page has named."""
    names, _, conditions = text.partition(";")
    names, condition = tuple(names.split()), parse_filter(conditions)
    if len(names) == 1 and names[0] in known:
        return Rows(known[names[0]].names, known[names[0]].filter.and_also(condition))
    if not names or any("." not in name for name in names):
        raise DocsError(f"'{' '.join(names)}' is neither files nor the name of a <!--rows NAME = ...--> of this page")
    return Rows(names, condition)


def parse_query(text, known):
    """Parses a query. `known`: the rows that the page has named. Raises DocsError."""
    parts = [part.strip() for part in text.split(";")]
    if len(parts) not in (4, 5):
        raise DocsError(f"'{text}' is not a query: SOURCES; FILTER; VALUE; STATISTIC; FORMAT")
    *rows, value, statistic, form = parts
    name, _, base = statistic.partition(" ")
    if name not in OF_VALUES and name not in OF_TWO and name != "only":
        raise DocsError(f"'{name}' is not a statistic: {', '.join([*OF_VALUES, 'only', *OF_TWO])}")
    if bool(base) != (name in OF_TWO):
        raise DocsError(f"statistic '{name}' takes {'the filter of its base' if name in OF_TWO else 'no filter'}")
    found = FORMAT.fullmatch(form)
    if not found:
        raise DocsError(f"'{form}' is not a format: an optional scale, * or / and a number, and Python's format")
    sign, number, spec = found.groups()
    scale = float(number or 1)
    return Query(parse_rows(" ; ".join(rows), known), Expression(value), name,
                 parse_filter(base) if base else None, 1 / scale if sign == "/" else scale, spec)


def answer(query, sources, provenance):
    """Returns (the text that the figure must be, the rows behind it). Raises DocsError."""
    every = [row for name in query.rows.names for row in sources.rows(name) if not row.get("warmup")]
    is_published = all(name.startswith("paper/") for name in query.rows.names)
    rows = [row for row in every if query.rows.filter.matches(row)]
    base = []
    if query.base is not None:
        base_filter = query.rows.filter.changed(query.base)
        base = [row for row in every if base_filter.matches(row)]
        if not base:
            raise DocsError("no row matches the filter of the base")
    if unknown := query.rows.filter.unknown_to(every):
        raise DocsError(f"no row has '{unknown[0]}'")
    if not rows and query.statistic != "count":
        raise DocsError("no row matches the filter")
    value = FACT if query.statistic == "count" else query.value
    fault = "" if is_published else provenance.fault_of(rows + base, value)
    if fault:
        raise DocsError(fault)
    try:
        return formatted(_statistic(query, rows, base), query), rows + base
    except (TypeError, ArithmeticError, statistics.StatisticsError) as error:
        raise DocsError(f"{query.statistic} of '{query.value.text}': {error}") from None


def formatted(value, query):
    if query.format == "words":
        if value not in range(len(WORDS)):
            raise DocsError(f"{value} has no word: they go up to {WORDS[-1]}")
        return WORDS[int(value)]
    if isinstance(value, str):
        return value
    value *= query.scale
    try:
        return format(round(value) if query.format.endswith("d") else value, query.format)
    except ValueError:
        raise DocsError(f"'{query.format}' is not a format of a number") from None


def _statistic(query, rows, base):
    if query.statistic == "count":
        return len(rows)
    values = [query.value.of(row) for row in rows]
    if query.statistic == "only":
        if any(value != values[0] for value in values):
            raise DocsError(f"{len(values)} rows have different values: {values[0]}, {values[-1]}")
        return values[0]
    if query.statistic in OF_VALUES:
        return OF_VALUES[query.statistic](values)
    if query.statistic == "ratio-of-medians":
        return statistics.median(values) / statistics.median(map(query.value.of, base))
    return OF_RATIOS[query.statistic](_ratios_within_rounds(query, rows, base))


def _ratios_within_rounds(query, rows, base):
    above, below = (_by_round(query.value, some) for some in (rows, base))
    rounds = sorted(above.keys() & below.keys())
    if not rounds:
        raise DocsError("no round has rows of both sides")
    return [above[one] / below[one] for one in rounds]


def _by_round(value, rows):
    found = {}
    for row in rows:
        if row.get("probe_moved"):  # the machine's speed changed during the round
            continue
        if row.get("repeat") in found:
            raise DocsError(f"two rows of one side in round {row.get('repeat')}")
        found[row.get("repeat")] = value.of(row)
    return found
