"""Draws weak scaling on ranks: simulated and measured efficiencies in separate panels, and the parts of the time."""
import numpy
import pandas

from . import scaling, style
from .distributed import PARTS
from .distributed_model import ASSUMPTIONS

COLOURS = dict(zip(PARTS, ["#8fb996", "#e8a33d", "#e6d5e8", "#d1495b", "#8f575c", "#c9b458",
                           style.PUBLISHED_GREY, "#3d3d6b", "#6d9dc5"]))


# Drawn without a line, because these points were not simulated.
EXTRAPOLATED = {"linestyle": "none", "marker": "D", "markersize": 4, "markerfacecolor": "none"}


def figure(table, extrapolated):
    """Draws efficiencies against ranks: simulated with their extrapolation, and measured in a panel of their own; then
    the parts of the simulated time. None without rows on more than one rank."""
    if not (table["ranks"] > 1).any():
        return None
    titles = {"simulated": "weak efficiency of refining, simulated",
              "measured": "cells per processor second, measured over MPI"}
    bases = [basis for basis in titles if (table["basis"] == basis).any()]
    has_parts = "simulated" in bases
    drawn, panels = style.new_figure(columns=len(bases) + has_parts, width=5.3 * (len(bases) + has_parts), height=4.4)
    for axes, basis in zip(numpy.atleast_1d(panels), bases):
        _efficiencies(axes, table[table["basis"] == basis], style.LINES[basis])
        if basis == "simulated":
            _extrapolations(axes, extrapolated)
        style.cores_axis(axes, [*table["ranks"], *extrapolated["ranks"]])
        axes.axhline(100, color=style.INK, linewidth=0.8)
        axes.set(title=titles[basis], xlabel="ranks", ylabel="over one rank, %", ylim=(0, 175),
                 yticks=range(0, 101, 20))
        style.legend(axes, loc="upper right")
    if has_parts:
        _parts(panels[-1], table[table["basis"] == "simulated"], extrapolated)
    style.finish(drawn, caption(table, extrapolated))
    return drawn


def _efficiencies(axes, table, line):
    for number, (per_rank, group) in enumerate(table.groupby("cells_per_rank")):
        group = group[group["refining_efficiency"].notna()]
        if (group["ranks"] > 1).any():
            axes.plot(group["ranks"], 100 * group["refining_efficiency"], marker="osD^v<>"[number % 7],
                      color=list(COLOURS.values())[number % len(COLOURS)],
                      label=f"{scaling.short(per_rank)} cells per rank", **line)


def _extrapolations(axes, table):
    for threads, group in table.groupby("threads"):
        middle = 100 * group["refining_efficiency"]
        bars = numpy.nan_to_num([middle - 100 * group["refining_efficiency_low"],
                                 100 * group["refining_efficiency_high"] - middle]).clip(0)
        axes.errorbar(group["ranks"], middle, yerr=bars, capsize=3, color=style.INK,
                      label=f"extrapolated, {scaling.short(group['cells_per_rank'].iloc[0])} cells per node of "
                            f"{threads} thread{'s' * (threads > 1)}",
                      **{**EXTRAPOLATED, "marker": "D" if threads == 1 else "s"})


def _parts(axes, table, extrapolated):
    """Draws a bar per size and number of ranks; extrapolated bars are hatched, and have one thread."""
    bars = [(scaling.short(line["cells_per_rank"]), line, hatch)
            for lines, hatch in ((table, ""), (extrapolated[extrapolated["threads"] == 1], "////"))
            for _, line in lines.iterrows()]
    for part, words in PARTS.items():
        heights = [0 if pandas.isna(line[part]) else line[part] for _, line, _ in bars]
        below = [sum(0 if pandas.isna(line[one]) else line[one] for one in list(PARTS)[:list(PARTS).index(part)])
                 for _, line, _ in bars]
        axes.bar(range(len(bars)), heights, 0.7, bottom=below, color=COLOURS[part], label=words, edgecolor=style.INK,
                 linewidth=0.3, hatch=[hatch for *_, hatch in bars])
    axes.set_xticks(range(len(bars)), [line["ranks"] for _, line, _ in bars], fontsize=7)
    sizes = [name for name, *_ in bars]
    middles = {name: numpy.mean([i for i, other in enumerate(sizes) if other == name]) for name in sizes}
    below = axes.secondary_xaxis("bottom")
    below.tick_params(axis="x", length=0, pad=16)
    below.set_xticks(list(middles.values()), list(middles), fontsize=7)
    below.spines["bottom"].set_visible(False)
    below.set_xlabel("ranks, and cells of each (hatched: extrapolated)")
    axes.set(title="where the time of the mean rank goes",
             ylabel="simulated microseconds per cell of a rank")
    handles, labels = axes.get_legend_handles_labels()
    style.legend(axes, handles=handles[::-1], labels=labels[::-1], **style.BESIDE)


def caption(table, extrapolated):
    parts = []
    if (table["basis"] == "simulated").any():
        parts.append("Simulated: ranks of one thread in one process, one after the other, timed by their "
                     "processor time and a stated network; the weak efficiency is cells per second and rank over "
                     "those of one rank with the same number of cells")
    if (table["basis"] == "measured").any():
        parts.append("Measured: ranks over MPI on one machine with fewer processors; cells per processor second "
                     "outside of collectives, because waiting there means nothing")
    if len(extrapolated):
        parts.append(ASSUMPTIONS)
    return ". ".join(parts) + "."
