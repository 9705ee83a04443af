"""Figure 4 (b): seconds by phase, and elements per second, against cores. Simulated seconds have separate axes."""
import numpy
from matplotlib.patches import Patch

from . import paper, scaling, style

SIDES = ["pdr-podm", "podm", "podm-home"]  # bars of one number of cores, from left to right


def fig4b(series):
    """Draws the median seconds of each phase as bars, virtual seconds for simulated rows. The paper's totals, whose
    parts are not printed, are beside the measured bars."""
    measured, simulated = scaling.first_of(series, "measured"), scaling.first_of(series, "simulated")
    figure, axes = style.new_figure(columns=2, rows=2 if simulated else 1, width=11.0, height=8.0 if simulated else 4.2)
    seconds, rate, beside_rate = (axes[0], axes[2], axes[3]) if simulated else (*axes, axes[1])
    published = paper.table1()
    shown = scaling.shown_of(series)
    _bars(seconds, measured, scaling.core_counts([published, *([measured.table] if measured else [])]), published)
    seconds.set(ylabel="seconds of equation 1", title="time")
    if simulated:
        _bars(axes[1], simulated, scaling.core_counts([simulated.table]))
        axes[1].set(ylabel="simulated seconds of equation 1", title=f"time, {simulated.kind()}")
        axes[3].set_axis_off()
    style.plot_published(rate, published, "rate", 1e-6)
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
    """Draws stacks of a series, if given, in front of the paper's totals, if given."""
    handles = [Patch(color=colour, label=style.PHASE_NAMES.get(phase, phase))
               for phase, colour in style.PHASE_COLOURS.items() if series and (series.table[phase] > 0).any()]
    if published is not None:
        _published_bars(axes, published, cores, _sides(series))
        handles.append(Patch(facecolor="none", edgecolor=style.PUBLISHED_GREY, linestyle="--", label="paper, total"))
    if series:
        _stack(axes, series, cores)
    axes.set_ylim(0, 1.25 * axes.dataLim.y1)
    axes.set_xticks(range(len(cores)), [str(count) for count in cores])
    axes.set_xlabel(f"cores (bars, from left: {', '.join(style.NAMES[one] for one in _sides(series))})")
    style.legend(axes, handles=handles, loc="upper left", ncols=3)


def _sides(series):
    """Returns the algorithms of a group of bars: the paper's two, and the other algorithms of the series."""
    beyond = SIDES[len(paper.ALGORITHMS):]
    return SIDES[:len(paper.ALGORITHMS)] + [one for one in beyond if series and one in series.table.index]


def _place(algorithm, sides):
    """Returns (offset of the middle from that of the group, width)."""
    width = 0.72 / len(sides)
    return (sides.index(algorithm) - (len(sides) - 1) / 2) * width, width


def _published_bars(axes, published, cores, sides):
    for (algorithm, count), row in published.iterrows():
        middle, width = _place(algorithm, sides)
        axes.bar(cores.index(count) + middle, row["seconds"], width, facecolor="none", edgecolor=style.PUBLISHED_GREY,
                 linestyle="--", linewidth=0.9)


def _stack(axes, series, cores):
    is_simulated = series.key["basis"] == "simulated"
    sides = _sides(series)
    for (algorithm, count), row in series.table.iterrows():
        if algorithm not in sides:
            continue
        middle, width = _place(algorithm, sides)
        parts = row[scaling.PHASES].to_numpy(dtype=float)
        bottoms = numpy.concatenate([[0], numpy.cumsum(parts)[:-1]])
        axes.bar(cores.index(count) + middle, parts, 0.85 * width, bottom=bottoms,
                 hatch="////" if is_simulated else None, edgecolor=style.INK, linewidth=0.4,
                 color=[style.PHASE_COLOURS[phase] for phase in scaling.PHASES])
