"""Weak scaling on ranks that share no memory: rows of podm-mpi, by threads of a rank and cells per rank.

Simulated ranks, and their threads, compute one after the other in virtual time. Their efficiency is the cells per
second and rank over those of one rank with the same number of cells and threads. Ranks over MPI on one machine must
share its processors. For them the table has the processor seconds outside of collectives, and the cells per processor
second over those of one rank; waiting does not count.
"""
import math

import numpy
import pandas

from . import scaling

REFINING = ("initial", "refine", "later", "exchange")
# Where the mean rank spends its time, in the order of the stack. Waiting and network are those of refinement.
PARTS = {"transform": "image transform", "initial": "blocks and seeds", "refine": "round 0", "later": "later rounds",
         "exchange": "updates", "waiting": "waiting", "network": "network", "extract": "pieces"}
OF_ROW = ["deferred_share", "imbalance", "cells_over_one_machine", "rank_bytes_per_cell", "store_cells_per_cell",
          "learnt_per_vertex"]
COLUMNS = ["basis", "kind", "cells_per_rank", "ranks", "threads", "n", "cells", "rounds", *OF_ROW,
           "refining_efficiency", "efficiency", *PARTS]


def of_row(row):
    """Returns the derived values of a row on ranks; the parts are seconds of the mean rank. None for other rows."""
    ranks = row.get("ranks")
    if not ranks:
        return None
    number, spent = ranks["number"], [rank["spent"] for rank in ranks["by_rank"]]
    is_measured, cells = row["basis"] == "measured", row["cells"]

    def mean(phases, *kinds):
        return sum(_seconds(one, phases, kinds) for one in spent) / number

    every = ("computing",) if is_measured else ("computing", "waiting", "network")
    made = {phase: mean([phase], "computing") for phase in REFINING}
    made.update({phase: mean([phase], *every) for phase in ("transform", "extract")})
    made.update({kind: mean(REFINING, kind) for kind in every[1:]})
    rounds, asked = ranks["rounds"], row.get("asked", {}).get("target_elements")
    resolved = (row.get("resolved") or {}).get("cells")
    return {
        "number": number, "threads": max(rank.get("threads", 1) for rank in ranks["by_rank"]),
        "asked_cells": asked or cells, "cells_per_rank": (asked or cells) / number, "rounds": len(rounds),
        "deferred_share": rounds[0]["deferred"] / cells if rounds and cells else None, "imbalance": ranks["imbalance"],
        "cells_over_one_machine": cells / resolved if resolved else None,
        "rank_bytes_per_cell": (row.get("process") or {}).get("bytes_per_cell_beyond_image") if is_measured else None,
        "store_cells_per_cell": sum(rank.get("store_cells", 0) for rank in ranks["by_rank"]) / cells if cells else None,
        "learnt_per_vertex": _learnt(ranks) / row["vertices"] if row.get("vertices") else None,
        # In virtual time the seconds of the rank that ends last; in processor time those of the mean rank.
        "refining_s": _whole(spent, REFINING, every, is_measured),
        "whole_s": _whole(spent, ("transform", *REFINING, "extract"), every, is_measured), "part": made}


def _learnt(ranks):
    """Returns the number of vertices that ranks inserted as seeds, or because another rank has them."""
    updates = [*(one.get("update", {}) for one in ranks["rounds"]), ranks.get("last_update", {})]
    return (sum(rank.get("seed_vertices", 0) for rank in ranks["by_rank"])
            + sum(update.get("inserted", 0) for update in updates))


def _seconds(spent, phases, kinds):
    return sum(spent[phase][f"{kind}_s"] for phase in phases if phase in spent for kind in kinds)


def _whole(spent, phases, kinds, is_measured):
    sums = [_seconds(one, phases, kinds) for one in spent]
    return numpy.mean(sums) if is_measured else max(sums)


def distributed(frame):
    """One line per basis, cells per rank, number of ranks and threads, medians over repeats; the parts are microseconds
    per cell of the mean rank. Rows must be verified and come from the newest program and machine."""
    lines = []
    for basis, group in newest_rows(frame):
        for (threads, per_rank, ranks), some in group.groupby(["on_ranks.threads", "on_ranks.cells_per_rank",
                                                               "on_ranks.number"]):
            lines.append(_line(basis, int(threads), per_rank, int(ranks), some, _base(group, threads, per_rank)))
    return pandas.DataFrame(lines, columns=COLUMNS)


def newest_rows(frame):
    """Yields the rows of each basis, of its newest program and machine."""
    if "on_ranks.number" not in frame:
        return
    rows = frame[frame["on_ranks.number"].notna() & (frame["unproved"] == "") & ~frame["moved"]]
    for basis, group in rows.groupby("basis"):
        newest = group.iloc[-1]
        yield basis, group[(group["machine"] == newest["machine"]) & (group["build"] == newest["build"])]


def _base(group, threads, per_rank):
    """Returns the rows of one rank with the same number of cells and threads."""
    return group[(group["on_ranks.number"] == 1) & (group["on_ranks.cells_per_rank"] == per_rank)
                 & (group["on_ranks.threads"] == threads)]


def _line(basis, threads, per_rank, ranks, rows, base):
    def rate(of, what):
        return median(of["cells"] / of["on_ranks.number"] / of[f"on_ranks.{what}_s"])

    cells_of_rank = rows["cells"] / ranks
    parts = {part: 1e6 * median(rows[f"on_ranks.part.{part}"] / cells_of_rank) for part in PARTS
             if f"on_ranks.part.{part}" in rows}
    kind = "measured processor seconds" if basis == "measured" else "simulated"
    return {"basis": basis, "kind": f"{kind}, {scaling.short(per_rank)} cells per rank", "cells_per_rank": per_rank,
            "ranks": ranks, "threads": threads, "n": len(rows), "cells": rows["cells"].median(),
            "rounds": rows["on_ranks.rounds"].max(), **{name: median(rows[f"on_ranks.{name}"]) for name in OF_ROW},
            "refining_efficiency": rate(rows, "refining") / rate(base, "refining") if len(base) else math.nan,
            "efficiency": rate(rows, "whole") / rate(base, "whole") if len(base) else math.nan, **parts}


def median(column):
    known = column.dropna().astype(float)
    return known.median() if len(known) else math.nan


def readable(table):
    """Percent, and microseconds per cell with three digits."""
    shown = table[["kind", "ranks", "threads", "n"]].rename(
        columns={"kind": "basis", "threads": "threads of a rank", "n": "runs"}).copy()
    shown["M cells"] = [f"{1e-6 * cells:.3g}" for cells in table["cells"]]
    shown["rounds"] = table["rounds"].astype(int)
    for name, title in (("refining_efficiency", "efficiency, refining"), ("efficiency", "efficiency, whole"),
                        ("deferred_share", "share of cells deferred in round 0"),
                        ("cells_over_one_machine", "cells over those of one machine")):
        shown[title] = _shares(table[name], 2 if name == "cells_over_one_machine" else 1)
    shown["imbalance"] = [f"{value:.3f}" for value in table["imbalance"]]
    for name, title, digits in (("store_cells_per_cell", "cells of all stores per cell of the mesh", 2),
                                ("learnt_per_vertex", "seeds and vertices learnt per vertex of the mesh", 2),
                                ("rank_bytes_per_cell", "bytes per cell of the largest rank", 0)):
        shown[title] = ["" if pandas.isna(value) else f"{value:.{digits}f}" for value in table[name]]
    for part, words in PARTS.items():
        shown[f"{words}, us per cell"] = ["" if pandas.isna(value) else f"{value:.3g}" for value in table[part]]
    return shown


def _shares(column, digits):
    return ["" if pandas.isna(value) else f"{100 * value:.{digits}f} %" for value in column]
