"""Figure 4 (b): seconds by phase, and elements per second, against cores."""
import numpy
from matplotlib.patches import Patch

from . import paper, scaling, style

WIDTH = 0.36


def fig4b(series):
    """Bars: the median seconds of each phase, virtual ones of simulated rows; beside them the paper's totals, whose
    parts are not printed."""
    figure, (seconds, rate) = style.new_figure(columns=2, height=4.2)
    published = paper.table1()
    shown = scaling.shown_of(series)
    cores = scaling.core_counts([published, *(one.table for one in shown)])
    _ghost_bars(seconds, published, cores)
    stacked = [one for one in shown if not one.grows]
    for place, one in enumerate(stacked):
        _stack(seconds, one, cores, place - (len(stacked) - 1) / 2, 0.85 * WIDTH / max(1, len(stacked)))
    seconds.set_ylim(0, 1.05 * seconds.dataLim.y1)
    seconds.set_xticks(range(len(cores)), [str(count) for count in cores])
    seconds.set(xlabel="cores", ylabel="seconds of equation 1", title="time: PDR.PODM left, PODM right of each pair")
    style.legend(seconds, handles=_handles(stacked), loc="upper left", ncols=2)
    style.ghost(rate, published, "rate", 1e-6)
    for one in shown:
        style.plot_series(rate, one, "rate", 1e-6)
    style.cores_axis(rate, cores)
    rate.set_yscale("log")
    rate.yaxis.set_major_formatter("{x:g}")
    rate.set(ylabel="million elements per second", title="elements per second")
    style.legend(rate, loc="upper left")
    has_simulated = scaling.first_of(series, "simulated") is not None
    style.finish(figure, style.caption_of(shown)
                 + (" Simulated bars are hatched: virtual seconds of the phases." if has_simulated else ""))
    return figure


def _handles(stacked):
    made = [Patch(color=colour, label=style.PHASE_NAMES.get(phase, phase))
            for phase, colour in style.PHASE_COLOURS.items() if any((one.table[phase] > 0).any() for one in stacked)]
    return [*made, Patch(facecolor="none", edgecolor=style.GHOST, linestyle="--", label="paper, total")]


def _side(algorithm):
    return -WIDTH / 2 if algorithm == "pdr-podm" else WIDTH / 2


def _ghost_bars(axes, published, cores):
    for (algorithm, count), row in published.iterrows():
        axes.bar(cores.index(count) + _side(algorithm), row["seconds"], WIDTH, facecolor="none",
                 edgecolor=style.GHOST, linestyle="--", linewidth=0.9)


def _stack(axes, series, cores, place, width):
    """`place`: of this basis beside the others, in bars from the middle."""
    is_simulated = series.key["basis"] == "simulated"
    for (algorithm, count), row in series.table.iterrows():
        if algorithm not in style.NAMES:
            continue
        parts = row[scaling.PHASES].to_numpy(dtype=float)
        bottoms = numpy.concatenate([[0], numpy.cumsum(parts)[:-1]])
        axes.bar(cores.index(count) + _side(algorithm) + place * width, parts, width, bottom=bottoms,
                 hatch="////" if is_simulated else None, edgecolor=style.INK, linewidth=0.4,
                 color=[style.PHASE_COLOURS[phase] for phase in scaling.PHASES])
