"""Strong scaling on simulated ranks that share no memory: the same number of cells in all, on more ranks."""
import pandas

from .distributed import median, newest_rows

PARTS = ("refining", "whole")
COLUMNS = ["cells", "ranks", "threads", "n", *(f"{part}_{what}" for part in PARTS for what in ("s", "speedup",
                                                                                              "efficiency"))]


def strong(frame):
    """One line per number of ranks of which one rank with as many threads makes as many cells; that rank has a line if
    another number of ranks has one."""
    lines = []
    for basis, group in newest_rows(frame):
        for (threads, _), same in group.groupby(["on_ranks.threads", "on_ranks.asked_cells"]):
            base = same[same["on_ranks.number"] == 1]
            if basis == "simulated" and len(base) and (same["on_ranks.number"] > 1).any():
                lines += [_line(int(threads), int(ranks), some, base)
                          for ranks, some in same.groupby("on_ranks.number")]
    return pandas.DataFrame(lines, columns=COLUMNS)


def _line(threads, ranks, rows, base):
    line = {"cells": rows["cells"].median(), "ranks": ranks, "threads": threads, "n": len(rows)}
    for part in PARTS:
        spent_s = median(rows[f"on_ranks.{part}_s"])
        speedup = median(base[f"on_ranks.{part}_s"]) / spent_s
        line.update({f"{part}_s": spent_s, f"{part}_speedup": speedup, f"{part}_efficiency": speedup / ranks})
    return line


def readable(table):
    """Seconds with three digits, and percent."""
    shown = table[["ranks", "threads", "n"]].rename(columns={"threads": "threads of a rank", "n": "runs"}).copy()
    shown.insert(0, "M cells", [f"{1e-6 * cells:.3g}" for cells in table["cells"]])
    for part in PARTS:
        shown[f"seconds, {part}"] = [f"{seconds:.3g}" for seconds in table[f"{part}_s"]]
        shown[f"speed-up, {part}"] = [f"{speedup:.3g}" for speedup in table[f"{part}_speedup"]]
        shown[f"efficiency, {part}"] = [f"{100 * share:.1f} %" for share in table[f"{part}_efficiency"]]
    return shown
