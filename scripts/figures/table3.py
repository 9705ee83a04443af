"""Table 3: memory levels and the cost of an access. Our values are `memory_levels` of rows that measured the
machine."""
import pandas

from . import paper
from .spread import median_interval, order_interval

COLUMNS = ["basis", "level", "memory_module", "size", "access_clock_cycles"]


def table3(frame):
    """One line per basis and level. Cycles are text: as printed, or medians of the newest machine's, or the reason why
    they are missing."""
    published = paper.table3().reset_index().assign(basis="published")
    lines = [{"basis": "measured", "level": row["level"], "memory_module": row["module"],
              "size": _size(row["size_bytes"]), "access_clock_cycles": row["text"]}
             for _, row in costs(frame).iterrows()]
    return pandas.concat([published, pandas.DataFrame(lines)], ignore_index=True)[COLUMNS]


def readable(table):
    return table[["level", "memory_module", "size", "access_clock_cycles", "basis"]].rename(
        columns={"memory_module": "memory module", "access_clock_cycles": "clock cycles"})


def costs(frame):
    """One line per level: median `cycles`, nan if they could not be measured, their `text`, and `is_another`, True for
    memory of another node."""
    levels = _levels(frame)
    lines = []
    for (level, module), group in levels.groupby(["level", "module"]) if len(levels) else ():
        measured = pandas.to_numeric(group["cycles"], errors="coerce").dropna()
        cycles, low, high = median_interval(measured)
        lines.append({"level": level, "module": module, "size_bytes": group["size_bytes"].iloc[-1], "cycles": cycles,
                      "cycles_low": low, "cycles_high": high, "coverage": order_interval(measured)[2],
                      "text": group["cycles"].iloc[-1] if pandas.isna(cycles) else f"{cycles:.3g}",
                      "is_another": "another node" in module})
    columns = ["level", "module", "size_bytes", "cycles", "cycles_low", "cycles_high", "coverage", "text", "is_another"]
    return pandas.DataFrame(lines, columns=columns).astype({"is_another": bool})


def _levels(frame):
    """Returns all rows of the machine that the newest row measured."""
    if "memory_levels" not in frame:
        return pandas.DataFrame()
    rows = frame[[isinstance(levels, list) for levels in frame["memory_levels"]]]
    rows = rows[rows["machine"] == rows["machine"].iloc[-1]] if len(rows) else rows
    return pandas.DataFrame([level for levels in rows["memory_levels"] for level in levels])


def _size(number):
    if number is None or pandas.isna(number):
        return ""
    for unit in ("B", "KiB", "MiB"):
        if number < 1024:
            return f"{number:.4g} {unit}"
        number /= 1024
    return f"{number:.4g} GiB"
