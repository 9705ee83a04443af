"""Table 3: memory levels and what an access costs. Ours come from `memory_levels` of rows that measured the machine."""
import pandas

from . import paper

COLUMNS = ["basis", "level", "memory_module", "size", "access_clock_cycles"]


def table3(frame):
    """One line a basis and level. Cycles are text: as printed, or medians of the newest machine's, or why there are none."""
    blocks = [paper.table3().reset_index().assign(basis="published")]
    levels = _levels(frame)
    for (level, module), group in levels.groupby(["level", "module"]) if len(levels) else ():
        cycles = pandas.to_numeric(group["cycles"], errors="coerce").median()
        blocks.append(pandas.DataFrame([{
            "basis": "measured", "level": level, "memory_module": module, "size": _size(group["size_bytes"].iloc[-1]),
            "access_clock_cycles": group["cycles"].iloc[-1] if pandas.isna(cycles) else f"{cycles:.3g}"}]))
    return pandas.concat(blocks, ignore_index=True)[COLUMNS]


def readable(table):
    return table[["level", "memory_module", "size", "access_clock_cycles", "basis"]].rename(
        columns={"memory_module": "memory module", "access_clock_cycles": "clock cycles"})


def _levels(frame):
    """Of all rows of the machine that the newest one measured."""
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
