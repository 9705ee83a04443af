"""Figure 4 (b): seconds by phase, and elements per second, against cores. Simulated seconds have axes of their own."""
import numpy
from matplotlib.patches import Patch

from . import paper, scaling, style

WIDTH = 0.36


def fig4b(series):
    """Bars: the median seconds of each phase, virtual ones of simulated rows; beside the measured the paper's totals,
    whose parts are not printed."""
    measured, simulated = scaling.first_of(series, "measured"), scaling.first_of(series, "simulated")
    figure, axes = style.new_figure(columns=2, rows=2 if simulated else 1, width=11.0, height=8.0 if simulated else 4.2)
    seconds, rate, beside_rate = (axes[0], axes[2], axes[3]) if simulated else (*axes, axes[1])
    published = paper.table1()
    shown = scaling.shown_of(series)
    _bars(seconds, measured, scaling.core_counts([published, *([measured.table] if measured else [])]), published)
    seconds.set(ylabel="seconds of equation 1", title="time: PDR.PODM left, PODM right of each pair")
    if simulated:
        _bars(axes[1], simulated, scaling.core_counts([simulated.table]))
        axes[1].set(ylabel="simulated seconds of equation 1", title=f"time, {simulated.kind()}")
        axes[3].set_axis_off()
    style.ghost(rate, published, "rate", 1e-6)
    for one in shown:
        style.plot_series(rate, one, "rate", 1e-6)
    style.cores_axis(rate, scaling.core_counts([published, *(one.table for one in shown)]))
    rate.set_yscale("log")
    rate.yaxis.set_major_formatter("{x:g}")
    rate.set(ylabel="million elements per second", title="elements per second")
    handles, labels = rate.get_legend_handles_labels()
    place = {"loc": "upper left"} if simulated else style.BESIDE
    style.legend(beside_rate, handles=handles, labels=labels, **place)
    style.finish(figure, style.caption_of(shown)
                 + (" Simulated bars are hatched: virtual seconds of the phases, of fewer cells than the paper's."
                    if simulated else ""))
    return figure


def _bars(axes, series, cores, published=None):
    """Stacks of a series, if there is one, before the paper's totals, if they are given."""
    handles = [Patch(color=colour, label=style.PHASE_NAMES.get(phase, phase))
               for phase, colour in style.PHASE_COLOURS.items() if series and (series.table[phase] > 0).any()]
    if published is not None:
        _ghost_bars(axes, published, cores)
        handles.append(Patch(facecolor="none", edgecolor=style.GHOST, linestyle="--", label="paper, total"))
    if series:
        _stack(axes, series, cores)
    axes.set_ylim(0, 1.25 * axes.dataLim.y1)
    axes.set_xticks(range(len(cores)), [str(count) for count in cores])
    axes.set_xlabel("cores")
    style.legend(axes, handles=handles, loc="upper left", ncols=3)


def _side(algorithm):
    return -WIDTH / 2 if algorithm == "pdr-podm" else WIDTH / 2


def _ghost_bars(axes, published, cores):
    for (algorithm, count), row in published.iterrows():
        axes.bar(cores.index(count) + _side(algorithm), row["seconds"], WIDTH, facecolor="none",
                 edgecolor=style.GHOST, linestyle="--", linewidth=0.9)


def _stack(axes, series, cores):
    is_simulated = series.key["basis"] == "simulated"
    for (algorithm, count), row in series.table.iterrows():
        if algorithm not in style.NAMES:
            continue
        parts = row[scaling.PHASES].to_numpy(dtype=float)
        bottoms = numpy.concatenate([[0], numpy.cumsum(parts)[:-1]])
        axes.bar(cores.index(count) + _side(algorithm), parts, 0.85 * WIDTH, bottom=bottoms,
                 hatch="////" if is_simulated else None, edgecolor=style.INK, linewidth=0.4,
                 color=[style.PHASE_COLOURS[phase] for phase in scaling.PHASES])
