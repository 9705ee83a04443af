"""Cache behaviour: the counts per further insertion, from the processor or from a simulation of its caches."""
import pandas

from . import load

SERIES = ["basis", "source", "machine", "build", "image", "algorithm", "cores", "counter"]
SIZE = ["used.radius_mm"]
PREFIX = "process.counters."
COLUMNS = ["basis", "source", "algorithm", "cores", "cells", "counter", "per_insertion", "n", "reason"]
# Counted by the operating system's kernel; they do not describe caches.
NO_CACHE = {"task_clock_ns", "page_faults", "context_switches", "cpu_migrations"}


def cache(frame):
    """One line per series and size: the counts beyond those of the next smaller mesh of the series, divided by the
    insertions beyond its insertions. Both meshes pay the same to read their image, therefore this cost cancels. Then
    one line, with the reason, for each counter that could not be read."""
    rows = frame[frame["doubt"].isin(["", load.SIMULATED_CACHES]) & frame["cores"].notna()] if len(frame) else frame
    lines = [line for counter in _counters(rows) for line in _lines_of(rows, counter)]
    lines += _reasons(rows[rows["basis"] == "measured"]) if len(rows) else []
    return pandas.DataFrame(lines, columns=COLUMNS).astype({"n": "Int64", "cores": "Int64"})


def readable(table):
    numbers = table["per_insertion"].map("{:.3g}".format)
    shown = table.assign(per_insertion=numbers.where(table["reason"].isna(), table["reason"]),
                         cells=table["cells"].map("{:.3g}".format).where(table["cells"].notna(), ""))
    return shown.drop(columns="reason").rename(columns={"per_insertion": "per further insertion", "n": "runs"})


def _counters(rows):
    ending = ".value"
    named = [name.removeprefix(PREFIX).removesuffix(ending) for name in rows
             if name.startswith(PREFIX) and name.endswith(ending)]
    return [counter for counter in named if counter not in NO_CACHE]


def _reasons(rows):
    """Yields a line for each counter that is text in some row and a number in none, with the newest text."""
    for name in rows:
        counter = name.removeprefix(PREFIX)
        is_text = rows[name].map(lambda value: isinstance(value, str))
        if name != counter and "." not in counter and counter not in NO_CACHE and is_text.any():
            if f"{name}.value" not in rows or rows[f"{name}.value"].isna().all():
                yield {"basis": "measured", "counter": counter, "reason": rows[name][is_text].iloc[-1]}


def _lines_of(rows, counter):
    insertions = rows[[name for name in rows if name.startswith("counters.insertions.")]].sum(axis=1)
    counted = rows.reindex(columns=dict.fromkeys([*rows, *SERIES, *SIZE])).assign(
        counter=counter, insertions=insertions, source=rows[f"{PREFIX}{counter}.source"],
        count=rows[f"{PREFIX}{counter}.value"])
    counted = counted.dropna(subset=["count"]).fillna({name: 0 for name in SIZE})
    for values, group in counted.groupby(SERIES, sort=False):
        sizes = group.groupby(SIZE).agg(count=("count", "median"), insertions=("insertions", "median"),
                                        cells=("cells", "median"), n=("count", "size")).sort_values("insertions")
        further = sizes[["count", "insertions"]].diff()
        per_insertion = further["count"] / further["insertions"]
        for number, cells, n in zip(per_insertion, sizes["cells"], sizes["n"]):
            if not pandas.isna(number):
                yield dict(zip(SERIES, values), cells=cells, per_insertion=number, n=n)
