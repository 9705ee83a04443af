"""Cells per second of PODM and of other meshers, for experiments that gave all of them the same image.

The whole is all work between the image in memory and the mesh in memory. For meshers that begin with a finished surface
this includes making that surface; a separate column compares their volume part with PODM's.
"""
import re

import pandas

from . import scaling
from .spread import order_interval
from .table1 import with_bounds

RATES = ("whole_rate", "refining_rate", "volume_rate", "whole_ratio", "volume_ratio")
COLUMNS = ["experiment", "setting", "image", "machine", "mesher", "version", "cores", "n", "cells", "facets",
           *(name + end for name in RATES for end in ("", "_low", "_high")), "coverage", "promised", "kept", "not_run",
           "misses", "size_rank"]
GROUP = ["machine", "build", "experiment", "setting", "image"]
OWN, OWN_VOLUME = "podm", "podm_volume"
FIRST_SURFACE = "surface"  # phase of meshers that begin with a finished surface
LEFT_OUT = ("Refining leaves out the feature transform, allocation and extraction of PODM, the domain that CGAL "
            "prepares, and the surface that TetGen and HXT are given.")
COVERAGE = ("In brackets: from one order statistic to another; within rounds, so that a machine that grows slower does "
            "so for both. The column coverage is the probability that such an interval holds the median.")


def peers(frame):
    """One line per mesher of each trial that other meshers also ran; first on one core, then by size of PODM's mesh,
    largest first.

    Ratios are PODM's rate over the mesher's. `misses`: claims that failed, promised or not.
    """
    rows = _comparable(frame)
    lines = []
    for values, group in rows.groupby(GROUP, sort=False) if len(rows) else ():
        if not {OWN} < set(group["mesher"]):
            continue
        by_mesher = {mesher: scaling.of_one_size(one) for mesher, one in group.groupby("mesher")}
        shared = {**dict(zip(GROUP, values)), "cores": group["cores"].max(),
                  "size_rank": by_mesher[OWN]["cells"].median()}
        lines += [{**shared, "mesher": mesher, **_line(one, by_mesher)} for mesher, one in by_mesher.items()]
    table = pandas.DataFrame(lines, columns=COLUMNS)
    order = ["cores", "size_rank", "experiment", "setting", "whole_rate"]
    return table.sort_values(order, ascending=[True, False, True, True, False],
                             ignore_index=True).drop(columns="size_rank")


def readable(table):
    shown = table[["setting", "image", "cores", "mesher", "version", "n"]].copy()
    shown["M cells"] = [f"{cells / 1e6:.2f}" for cells in table["cells"]]
    shown["facets"] = [f"{facets:.0f}" if facets == facets else "not recorded" for facets in table["facets"]]
    shown["bounds met"] = [_bounds_met(line) for line in table.to_dict("records")]
    for name, title in (("whole_rate", "whole, M cells/s"), ("refining_rate", "refining, M cells/s"),
                        ("volume_rate", "from the surface, M cells/s")):
        shown[title] = _with_bounds(table, name, 1e-6, 3)
    shown["PODM over it, whole"] = _with_bounds(table, "whole_ratio", 1, 2)
    shown["PODM over it, from the surface"] = _with_bounds(table, "volume_ratio", 1, 2)
    shown["coverage"] = [f"{100 * one:.0f} %" if one == one else "" for one in table["coverage"]]
    return shown


def speed_table(frame):
    """The table of speed for a page: mesher, version, cores, cells, facets, the rate of the whole and PODM's ratio to
    it."""
    table = peers(frame)
    shown = readable(table[table["mesher"] != OWN_VOLUME])
    return shown[["setting", "cores", "mesher", "version", "n", "M cells", "facets", "bounds met", "whole, M cells/s",
                  "PODM over it, whole", "coverage"]]


def _with_bounds(table, name, scale, digits):
    columns = zip(*(table[name + end] * scale for end in ("", "_low", "_high")))
    return [with_bounds(*values, digits) for values in columns]


def _bounds_met(line):
    text = f"{line['kept']} of {line['promised']} promised"
    text += f", {line['not_run']} not run" if line["not_run"] else ""
    return text + (f"; misses {line['misses']}" if line["misses"] else "")


def _comparable(frame):
    """Returns verified rows of PODM, and rows of other meshers even if they miss claims that they do not promise."""
    if frame.empty or not (frame["mesher"] != OWN).any():
        return frame.iloc[:0]
    is_theirs = (frame["mesher"] != OWN) & (frame["status"] == "ok") & (frame["warmup"] != True)  # noqa: E712
    is_theirs &= ~frame["moved"]
    rows = frame[frame["headline"] & (frame["mesher"] == OWN) | is_theirs]
    rows = scaling.with_keys(rows[rows["cores"].notna()])
    return rows[(rows["basis"] == "measured") & rows["algorithm"].isin([OWN, *rows["mesher"]])]


def _line(rows, by_mesher):
    facets = rows["boundary_facets"] if "boundary_facets" in rows else pandas.Series(dtype=float)
    line = {"version": version_of(rows.iloc[-1]), "n": len(rows), "cells": rows["cells"].median(),
            "facets": _median(facets),
            "misses": ", ".join(misses_of(rows)), **_promises(rows)}
    line.update(_bounds("whole_rate", _whole_rate(rows)))
    line.update(_bounds("refining_rate", rows["cells"] / rows["refining_s"]))
    line.update(_bounds("volume_rate", _volume_rate(rows)))
    if rows is not by_mesher[OWN]:
        line.update(_ratio("whole_ratio", _whole_rate, by_mesher[OWN], rows))
    if OWN_VOLUME in by_mesher and rows is not by_mesher[OWN_VOLUME]:
        line.update(_ratio("volume_ratio", _volume_rate, by_mesher[OWN_VOLUME], rows))
    return line


def _whole_rate(rows):
    return rows["cells"] / rows["whole_s"]


def _volume_rate(rows):
    """Returns the rate of meshers that begin with a finished surface, nan for others. Cells made with the surface do
    not count."""
    if "timed." + FIRST_SURFACE not in rows:
        return pandas.Series(float("nan"), rows.index)
    before = rows["surface_cells"].fillna(0) if "surface_cells" in rows else 0
    return (rows["cells"] - before) / (rows["whole_s"] - rows["timed." + FIRST_SURFACE])


def _bounds(name, values):
    values = values.dropna()
    return dict(zip((name, name + "_low", name + "_high"), (_median(values), *order_interval(values)[:2])))


def _median(values):
    """Returns the median; nan without values."""
    values = values.dropna()
    return values.median() if len(values) else float("nan")


def _ratio(name, rate_of, own, others):
    """Computes PODM's rate over the other's in each round that both have."""
    by_round = [rate_of(rows).groupby(rows["repeat"]).last() for rows in (own, others)]
    ratios = (by_round[0] / by_round[1]).dropna()
    return {**_bounds(name, ratios), **({"coverage": order_interval(ratios)[2]} if len(ratios) else {})}


def version_of(row):
    """Returns "CGAL 5.5.1" from a mesher's full version text."""
    version = row.get("programs.peer.version")
    version = version if isinstance(version, str) else row.get("programs.podm.version", "")
    found = re.match(r"\S+ [\d.]*\d", version)
    return found.group() if found else version


def _promises(rows):
    """Counts the claims that the mesher promises, the promised claims that passed for all rows, and those not run."""
    names = [name for name in rows if name.startswith("verdicts.") and rows[name].notna().any()]
    promised = rows["promises"].iloc[-1] if "promises" in rows else None
    if not isinstance(promised, list):
        promised = [name.removeprefix("verdicts.") for name in names]
    verdicts = [rows.get(f"verdicts.{claim}", pandas.Series(dtype=object)) for claim in promised]
    return {"promised": len(promised), "kept": sum(len(one) > 0 and (one == "pass").all() for one in verdicts),
            "not_run": sum(not one.isin(["pass", "fail"]).any() for one in verdicts)}


def misses_of(group):
    """Returns the claims that failed for one of the rows, promised or not."""
    names = [name for name in group if name.startswith("verdicts.")]
    return sorted(name.removeprefix("verdicts.") for name in names if (group[name] == "fail").any())
