"""Draws weak scaling on ranks: by threads of a rank the parts of the simulated time and the efficiencies, and the
efficiencies of measured ranks in a panel of their own."""
import numpy
import pandas

from . import scaling, style
from .distributed import PARTS
from .distributed_model import ASSUMPTIONS

COLOURS = dict(zip(PARTS, ["#8fb996", "#e8a33d", "#d1495b", "#8f575c", "#c9b458", style.PUBLISHED_GREY, "#3d3d6b",
                           "#6d9dc5"]))
MARKERS = "osD^v<>"


def figure(table, extrapolated):
    """Draws a column for each number of threads of simulated ranks, with the parts of the time above the efficiencies,
    and a last column for measured ranks. None without rows on more than one rank."""
    if not (table["ranks"] > 1).any():
        return None
    simulated, measured = (table[table["basis"] == basis] for basis in ("simulated", "measured"))
    threads = sorted(set(simulated["threads"]))
    columns, rows = len(threads) + (len(measured) > 0), 2 if threads else 1
    drawn, panels = style.new_figure(columns=columns, rows=rows, width=5.3 * columns, height=4.4 * rows)
    for above, below, number in zip(panels, panels[columns:], threads):
        nodes = extrapolated[extrapolated["threads"] == number]
        lines = simulated[simulated["threads"] == number]
        _parts(above, lines, nodes)
        _efficiencies(below, lines, style.LINES["simulated"], nodes)
        below.set_title(f"ranks of {_threads(number)}: weak efficiency of refining, simulated")
    if threads:
        handles, labels = panels[0].get_legend_handles_labels()
        style.legend(panels[len(threads) - 1], handles=handles[::-1], labels=labels[::-1], **style.BESIDE)
    if len(measured):
        _efficiencies(panels[-1], measured, style.LINES["measured"], extrapolated.iloc[:0])
        panels[-1].set_title("cells per processor second, measured over MPI")
        if threads:
            panels[columns - 1].remove()
    style.finish(drawn, caption(table, extrapolated))
    return drawn


def most_ranks(simulated):
    """Returns the lines of the size that was simulated on the most ranks: the smallest size, if several were."""
    least = simulated.sort_values(["ranks", "cells_per_rank"], ascending=[False, True])["cells_per_rank"].iloc[0]
    return simulated[simulated["cells_per_rank"] == least].sort_values("ranks")


def _parts(axes, simulated, extrapolated):
    """Draws a bar per number of ranks; extrapolated bars are hatched."""
    lines = most_ranks(simulated)
    bars = [*(line for _, line in lines.iterrows()), *(line for _, line in extrapolated.iterrows())]
    hatches = [""] * len(lines) + ["////"] * len(extrapolated)
    heights = pandas.DataFrame([line[list(PARTS)] for line in bars]).astype(float).fillna(0).to_numpy()
    tops = heights.cumsum(axis=1)
    for number, (part, words) in enumerate(PARTS.items()):
        axes.bar(range(len(bars)), heights[:, number], 0.7, bottom=tops[:, number] - heights[:, number],
                 color=COLOURS[part], label=words, edgecolor=style.INK, linewidth=0.3, hatch=hatches)
    axes.set_xticks(range(len(bars)), [line["ranks"] for line in bars], fontsize=7)
    threads, size = lines["threads"].iloc[0], scaling.short(lines["cells_per_rank"].iloc[0])
    nodes = f"; hatched: {scaling.short(extrapolated['cells_per_rank'].iloc[0])}" if len(extrapolated) else ""
    axes.set(title=f"ranks of {_threads(threads)}: where the time of the mean rank goes", ylim=(0, 1.05 * tops.max()),
             xlabel=f"ranks of {size} cells{nodes}", ylabel="simulated microseconds per cell of a rank")


def _threads(number):
    return "1 thread" if number == 1 else f"{number} threads"


def _efficiencies(axes, table, line, extrapolated):
    """Draws a line per size. `extrapolated` is drawn without a line, because these points were not simulated."""
    for number, (per_rank, group) in enumerate(table[table["refining_efficiency"].notna()].groupby("cells_per_rank")):
        if (group["ranks"] > 1).any():
            axes.plot(group["ranks"], 100 * group["refining_efficiency"], marker=MARKERS[number % len(MARKERS)],
                      color=list(COLOURS.values())[number % len(COLOURS)],
                      label=f"{scaling.short(per_rank)} cells per rank", **line)
    nodes = extrapolated[extrapolated["ranks"] > 1]
    if len(nodes):
        middle = 100 * nodes["refining_efficiency"]
        bars = numpy.nan_to_num([middle - 100 * nodes["refining_efficiency_low"],
                                 100 * nodes["refining_efficiency_high"] - middle]).clip(0)
        axes.errorbar(nodes["ranks"], middle, yerr=bars, capsize=3, color=style.INK, linestyle="none", marker="D",
                      markersize=4, markerfacecolor="none",
                      label=f"extrapolated, {scaling.short(nodes['cells_per_rank'].iloc[0])} cells per node")
    style.cores_axis(axes, table["ranks"])
    axes.axhline(100, color=style.INK, linewidth=0.8)
    axes.set(xlabel="ranks", ylabel="over one rank, %", ylim=(0, 175), yticks=range(0, 101, 20))
    style.legend(axes, loc="upper right")


def caption(table, extrapolated):
    parts = []
    if (table["basis"] == "simulated").any():
        parts.append("Simulated: ranks and their threads in one process, one after the other, timed by their "
                     "processor time, a simulated schedule of the threads and a stated network; the weak efficiency is "
                     "cells per second and rank over those of one rank with as many cells and threads")
    if (table["basis"] == "measured").any():
        parts.append("Measured: ranks over MPI on one machine with fewer processors; cells per processor second "
                     "outside of collectives, because waiting there means nothing")
    if len(extrapolated):
        parts.append(ASSUMPTIONS)
    return ". ".join(parts) + "."
