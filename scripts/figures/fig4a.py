"""Figure 4 (a): weak-scaling speed-up and efficiency against cores."""
from . import paper, scaling, style

WHY_ABOVE = ("Equation 1 also counts reading and transforming one image, whose work does not grow with the cells and "
             "is partly shared by the cores: that lifts its efficiency, even above 100 %")


def fig4a(series):
    """Draws the paper's curves and the first series of each basis, and the efficiency of refining alone beside that of
    equation 1."""
    figure, (speedup, efficiency) = style.new_figure(columns=2, width=12.0, height=4.2)
    published = paper.table1()
    shown = scaling.shown_of(series)
    cores = scaling.core_counts([published, *(one.table for one in shown)])
    for axes, column, scale in ((speedup, "speedup", 1), (efficiency, "efficiency", 100)):
        style.plot_published(axes, published, column, scale)
        for one in shown:
            style.plot_series(axes, one, column, scale)
        style.cores_axis(axes, cores)
    for one in shown:
        if one.key["basis"] == "measured" and not one.grows:
            style.plot_series(efficiency, one, "refining_efficiency", 100, of=", refining alone", **style.REFINING)
    speedup.set_yscale("log", base=2)
    speedup.plot([1, max(cores)], [1, max(cores)], color=style.INK, linewidth=0.8)
    ticks = [2**power for power in range(0, 9)]
    speedup.set_yticks(ticks, [str(tick) for tick in ticks])
    speedup.set(ylabel="speed-up over PODM on one core", title="weak-scaling speed-up, equation 1")
    efficiency.set(ylabel="efficiency, %", ylim=(0, max(115, 1.05 * efficiency.dataLim.y1)), title="efficiency")
    efficiency.axhline(100, color=style.INK, linewidth=0.8, label="ideal")
    style.legend(efficiency, **style.BESIDE)
    style.finish(figure, f"{style.caption_of(shown)} {reading(series)}")
    return figure


def reading(series):
    """Explains why the efficiency of equation 1 exceeds that of refining alone, with both values if they were
    measured."""
    one = scaling.first_of(series, "measured")
    many = max(scaling.core_counts([one.table]), default=1) if one else 1
    if many == 1 or ("podm", many) not in one.table.index:
        return WHY_ABOVE + "."
    line = one.table.loc["podm", many]
    return (f"{WHY_ABOVE}: PODM on {many} cores has {100 * line['efficiency']:.0f} % by equation 1 and "
            f"{100 * line['refining_efficiency']:.0f} % in refining alone (median of ratios within rounds).")
