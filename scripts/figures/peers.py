"""Cells per second of PODM and of other meshers, where an experiment gave all of them the same image and bounds."""
import pandas

from . import scaling
from .table1 import with_bounds

COLUMNS = ["experiment", "setting", "image", "machine", "mesher", "cores", "n", "cells",
           *(name + end for name in ("refining_rate", "rate") for end in ("", "_low", "_high")), "misses", "size_rank"]
GROUP = ["machine", "build", "experiment", "setting", "image"]


def peers(frame):
    """One line a mesher of each trial that other meshers ran too, on one core; largest meshes of PODM first. `rate` is
    that of equation 1, nan where a mesher does not tell its seconds of reading. `misses`: claims that failed, promised
    or not."""
    rows = _comparable(frame)
    lines = []
    for values, group in rows.groupby(GROUP, sort=False) if len(rows) else ():
        if not {"podm"} < set(group["mesher"]):
            continue
        size = group.loc[group["mesher"] == "podm", "cells"].median()
        lines += [{**dict(zip(GROUP, values)), "mesher": mesher, "size_rank": size, **_line(scaling.of_one_size(one))}
                  for mesher, one in group.groupby("mesher")]
    table = pandas.DataFrame(lines, columns=COLUMNS)
    order = ["size_rank", "experiment", "setting", "refining_rate"]
    return table.sort_values(order, ascending=[False, True, True, False], ignore_index=True).drop(columns="size_rank")


def readable(table):
    shown = table[["setting", "image", "mesher", "n"]].copy()
    shown["M cells"] = [f"{cells / 1e6:.2f}" for cells in table["cells"]]
    for name, title in (("refining_rate", "refining, M cells/s"), ("rate", "equation 1, M cells/s")):
        columns = zip(*(table[name + end] * 1e-6 for end in ("", "_low", "_high")))
        shown[title] = [with_bounds(*values, 3) or "unavailable: its seconds of reading are not told"
                        for values in columns]
    shown["claims missed"] = table["misses"]
    return shown


def _comparable(frame):
    """Rows of one thread; of others also those that miss claims which they do not promise."""
    if frame.empty or not (frame["mesher"] != "podm").any():
        return frame.iloc[:0]
    is_theirs = ((frame["mesher"] != "podm") & (frame["status"] == "ok") & (frame["warmup"] != True)  # noqa: E712
                 & ~frame["moved"])
    rows = frame[(frame["headline"] & (frame["mesher"] == "podm") | is_theirs) & (frame["cores"] == 1)]
    rows = scaling.with_keys(rows)
    return rows[(rows["basis"] == "measured") & rows["algorithm"].isin(["podm", *rows["mesher"]])]


def _line(group):
    refining, whole = group["cells"] / group["refining_s"], group["cells"] / group["seconds"]
    line = {"n": len(group), "cores": 1, "cells": group["cells"].median()}
    line.update(_bounds("refining_rate", refining))
    if _tells_reading(group):
        line.update(_bounds("rate", whole))
    return {**line, "misses": ", ".join(misses_of(group))}


def _bounds(name, values):
    return dict(zip((name, name + "_low", name + "_high"), scaling.median_interval(values)))


def _tells_reading(group):
    """A mesher that is given a surface pays for reading in that phase."""
    return any(f"timed.{phase}" in group and group[f"timed.{phase}"].notna().any() for phase in ("read", "surface"))


def misses_of(group):
    """Claims that failed for one of the rows, promised or not."""
    names = [name for name in group if name.startswith("verdicts.")]
    return sorted(name.removeprefix("verdicts.") for name in names if (group[name] == "fail").any())
