"""Table 3: memory levels and what an access costs. Ours come from `environment.memory_levels` of the newest row."""
import pandas

from . import paper

COLUMNS = ["basis", "level", "memory_module", "size", "access_clock_cycles"]


def table3(frame):
    """One line a basis and level. Cycles are text as printed, or numbers of ours."""
    blocks = [paper.table3().reset_index().assign(basis="published")]
    if levels := _newest_levels(frame):
        blocks.append(pandas.DataFrame([
            {"basis": "measured", "level": level["level"], "memory_module": level["module"],
             "size": _size(level.get("size_bytes")), "access_clock_cycles": f"{level['cycles']:.3g}"}
            for level in levels
        ]))
    return pandas.concat(blocks, ignore_index=True)[COLUMNS]


def readable(table):
    return table[["level", "memory_module", "size", "access_clock_cycles", "basis"]].rename(
        columns={"memory_module": "memory module", "access_clock_cycles": "clock cycles"})


def _newest_levels(frame):
    name = "environment.memory_levels"
    lists = [] if name not in frame else [levels for levels in frame[name] if isinstance(levels, list)]
    return lists[-1] if lists else None


def _size(number):
    if number is None or pandas.isna(number):
        return ""
    for unit in ("B", "KiB", "MiB"):
        if number < 1024:
            return f"{number:.4g} {unit}"
        number /= 1024
    return f"{number:.4g} GiB"
