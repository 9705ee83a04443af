"""Quality of the cells of each label: a histogram per label and measure."""
import numpy
from figures import style
from views.colours import colours_of_labels
from views.quality import MEASURES, measured

MOST_LABELS = 40  # rows of the figure; tables have all
BINS = 60
ALL_CELLS = "all cells"


def quality_of(mesh):
    """Returns the values of the cells, by measure."""
    return {name: measured(mesh, name) for name in MEASURES}


def histograms(mesh, quality):
    """Draws a row for all cells and one for each label, the greatest volume first, with a column per measure. Heights
    are shares of the row's cells; the highest bars of all rows have the same height."""
    ranked, colours = mesh.labels_by_volume(), colours_of_labels(mesh)
    rows = [(ALL_CELLS, style.INK, numpy.ones(len(mesh.labels), bool))]
    rows += [(mesh.name_of(value), colours[value], mesh.labels == value) for value in ranked[:MOST_LABELS]]
    figure, axes = style.new_figure(columns=len(MEASURES), height=1.1 + 0.3 * len(rows), width=10)
    for one, (name, measure) in zip(axes, MEASURES.items()):
        low, high = _range(measure, quality[name])
        for row, (_, colour, chosen) in enumerate(rows):
            _draw_row(one, len(rows) - 1 - row, quality[name][chosen], (low, high), colour)
        one.set(title=measure.title, xlim=(low, high), ylim=(-0.15, len(rows)))
        one.set_yticks(numpy.arange(len(rows)) + 0.05, [])
        one.grid(axis="y", visible=False)
        one.tick_params(axis="y", length=0)
    axes[0].set_yticks(axes[0].get_yticks(), [label for label, *_ in reversed(rows)], va="bottom")
    more = f" The {MOST_LABELS} labels of the greatest volume of {len(ranked)}." if len(ranked) > MOST_LABELS else ""
    style.finish(figure, f"Shares of each label's cells, in {BINS} steps; each row to its own scale.{more}")
    return figure


def _range(measure, values):
    low = numpy.nanmin(values) if measure.low is None else measure.low
    high = numpy.nanmax(values) if measure.high is None else max(measure.high, numpy.nanmax(values))
    return low, high if high > low else low + 1


def _draw_row(axes, foot, values, limits, colour):
    counts, edges = numpy.histogram(values[~numpy.isnan(values)], BINS, limits)
    if counts.max() > 0:
        axes.stairs(foot + 0.85 * counts / counts.max(), edges, baseline=foot, fill=True, color=colour)
        axes.stairs(foot + 0.85 * counts / counts.max(), edges, baseline=foot, color=style.INK, linewidth=0.5)
