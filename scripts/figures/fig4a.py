"""Figure 4 (a): weak-scaling speed-up, and the efficiency that follows, against cores."""
from . import paper, scaling, style

READING = "Reading and transforming the image is the same work on any number of cores: where cells are few it lifts the efficiency."


def fig4a(series):
    """The paper's curves and the first series of each basis."""
    figure, (speedup, efficiency) = style.new_figure(columns=2, height=4.2)
    published = paper.table1()
    shown = scaling.shown_of(series)
    cores = scaling.core_counts([published, *(one.table for one in shown)])
    for axes, column, scale in ((speedup, "speedup", 1), (efficiency, "efficiency", 100)):
        style.ghost(axes, published, column, scale)
        for one in shown:
            style.plot_series(axes, one, column, scale)
        style.cores_axis(axes, cores)
    speedup.set_yscale("log", base=2)
    speedup.plot([1, max(cores)], [1, max(cores)], color=style.INK, linewidth=0.8, label="ideal")
    ticks = [2**power for power in range(0, 9)]
    speedup.set_yticks(ticks, [str(tick) for tick in ticks])
    speedup.set(ylabel="speed-up over PODM on one core", title="weak-scaling speed-up")
    efficiency.set(ylabel="efficiency, %", ylim=(0, max(115, 1.05 * efficiency.dataLim.y1)), title="efficiency")
    efficiency.axhline(100, color=style.INK, linewidth=0.8)
    style.legend(speedup, loc="upper left")
    style.finish(figure, f"{style.caption_of(shown)} {READING}")
    return figure
