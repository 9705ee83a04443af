"""The results of virtual workers by trial: virtual seconds, lost time, and hops. The wall time is the time to simulate
them on the present machine, not a time of the simulated machine."""
import pandas

from . import scaling
from .table1 import in_order
from .table2 import zero_hop_share

OVERHEADS = ("contention", "begging", "rollback")
TITLES = {
    "n": "runs", "cells": "M cells", "seconds": "simulated seconds", "rate": "M cells per simulated second",
    **{name: f"simulated {name}, worker seconds" for name in OVERHEADS}, "zero_hops": "simulated 0 hops",
    "wall_s": "wall time of the simulation, s"}
SCALES = {"cells": 1e-6, "rate": 1e-6}


def simulated(frame):
    """One line per trial, algorithm and number of workers: medians over its rows of one size."""
    rows = scaling.headline_rows(frame)
    rows = rows[rows["basis"] == "simulated"] if len(rows) else rows
    lines = []
    for values, group in rows.groupby([*scaling.KEY, "algorithm", "cores"], sort=False) if len(rows) else ():
        group = scaling.of_one_size(group)
        line = dict(zip([*scaling.KEY, "algorithm", "cores"], values), n=len(group), cells=group["cells"].median(),
                    seconds=group["seconds"].median(), rate=(group["cells"] / group["seconds"]).median())
        line.update({name: _median(group, f"overhead_s.{name}") for name in OVERHEADS})
        lines.append({**line, "zero_hops": _zero_hops(group), "wall_s": _median(group, "process.wall_s")})
    columns = [*scaling.KEY, "algorithm", "cores", *TITLES]
    return pandas.DataFrame(lines, columns=columns)


def readable(table):
    shown = table[["experiment", "setting", "image", "algorithm", "basis", "cores"]].copy()
    for name, title in TITLES.items():
        shown[title] = [_text(name, value) for value in table[name]]
    return in_order(shown).sort_values(["experiment", "setting", "image"], kind="stable", ignore_index=True)


def _text(name, value):
    if name == "n" or isinstance(value, str) or pandas.isna(value):
        return value
    return f"{100 * value:.2f} %" if name == "zero_hops" else f"{value * SCALES.get(name, 1):.3g}"


def _median(group, column):
    return group[column].median() if column in group else float("nan")


def _zero_hops(group):
    """Returns the zero-hop share of all rows together, or the reason why there is none."""
    counts = list(group["hops"]) if "hops" in group else []
    lists = [one for one in counts if isinstance(one, list)]
    if not lists:
        return next((one for one in reversed(counts) if isinstance(one, str)), float("nan"))
    return zero_hop_share([sum(one[0] for one in lists), sum(sum(one[1:]) for one in lists)])
