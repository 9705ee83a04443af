"""Compares simulated with measured runs: the same mesh by virtual workers and by threads of the described machine."""
import pandas

from . import scaling

# The columns that identify a mesh; rows of both bases share them.
MESH = ["experiment", "build", "image", "used.radius_mm", "used.delta_mm"]
STAGES = {"transform": "transform", "initial": "initial mesh", "refine": "refinement", "extract": "extract"}
LOSSES = ("contention", "begging", "rollback")
COLUMNS = [*MESH, "algorithm", "cores", "cells", "n", "seconds", *STAGES, "speedup", "measured_speedup", "lost",
           "measured_lost", "conflicts", "measured_conflicts"]


def validation(frame):
    """One line per mesh, algorithm and number of cores. `seconds` (equation 1) and stages: simulated over measured,
    minus 1. `speedup`: over the same algorithm on one core. `lost`: share of worker seconds of refinement lost to
    LOSSES. `conflicts`: operations rolled back over those committed. Medians; empty without rows of both bases."""
    rows = scaling.headline_rows(frame)
    if rows.empty or not set(MESH) <= set(rows):
        return pandas.DataFrame(columns=COLUMNS)
    lines = []
    for values, mesh in rows.groupby(MESH, sort=False):
        sides = {basis: {key: group for key, group in part.groupby(["algorithm", "cores"])}
                 for basis, part in mesh.groupby("basis")}
        measured, simulated = sides.get("measured", {}), sides.get("simulated", {})
        for key in sorted(measured.keys() & simulated.keys(), reverse=True):
            lines.append({**dict(zip(MESH, values)), **_line(key, measured, simulated)})
    return pandas.DataFrame(lines, columns=COLUMNS)


def readable(table):
    """Deviations in percent, with their signs."""
    shown = table[["image", "algorithm", "cores", "n"]].copy()
    shown.insert(1, "M cells", [f"{cells / 1e6:.2g}" for cells in table["cells"]])
    for name, title in {"seconds": "seconds of equation 1", **STAGES}.items():
        shown[f"{title}, simulated over measured"] = [_percent(value, "+.0f") for value in table[name]]
    for name, title, scale in (("speedup", "speed-up", 1), ("lost", "lost %", 100), ("conflicts", "conflicts %", 100)):
        shown[f"{title}, simulated (measured)"] = [f"{scale * ours:.2f} ({scale * theirs:.2f})" for ours, theirs
                                                   in zip(table[name], table["measured_" + name])]
    return shown


def _line(key, measured, simulated):
    ours, theirs = simulated[key], measured[key]
    line = {"algorithm": key[0], "cores": key[1], "cells": ours["cells"].median(), "n": len(theirs)}
    for name in ("seconds", *STAGES):
        column = name if name == "seconds" else f"timed.{name}"
        line[name] = _median(ours, column) / (_median(theirs, column) or float("nan")) - 1
    for prefix, side in (("", simulated), ("measured_", measured)):
        group, alone = side[key], side.get((key[0], 1), pandas.DataFrame())
        line[prefix + "speedup"] = _median(alone, "seconds") / _median(group, "seconds")
        lost = sum(_median(group, f"overhead_s.{name}") for name in LOSSES)
        line[prefix + "lost"] = lost / (key[1] * _median(group, "refining_s"))
        line[prefix + "conflicts"] = _median(group, "outcomes.lock_conflict") / _median(group, "outcomes.committed")
    return line


def _median(group, column):
    return group[column].dropna().median() if column in group else float("nan")


def _percent(value, form):
    return "" if pandas.isna(value) else f"{100 * value:{form}} %"
