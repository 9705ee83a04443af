"""The common look of all figures, and the words of legends and captions."""
import numpy
from matplotlib.figure import Figure

# Colour of text, axes and outlines. The report replaces it by the page's text colour.
INK = "#1f2430"
PUBLISHED_GREY = "#8c8c8c"
# The paper's two algorithms, then further algorithms.
NAMES = {"podm": "PODM", "pdr-podm": "PDR.PODM", "podm-home": "PODM at home"}
COLOURS = {"podm": "#2b7bba", "pdr-podm": "#d1495b", "podm-home": "#3d8b5f"}
MARKERS = {"podm": "o", "pdr-podm": "s", "podm-home": "^"}
BEYOND = " PODM at home is a design of ours, which the paper does not have."
PHASE_COLOURS = {"allocate": "#4c6a5b", "read": "#c9b458", "transform": "#8fb996", "octree": "#7a6c9d",
                 "initial": "#e8a33d", "refine": "#d1495b", "closing": "#8f575c", "extract": "#6d9dc5",
                 "other": "#b0b0b0"}
PHASE_NAMES = {"allocate": "allocation", "initial": "initial mesh", "refine": "refinement"}
LINES = {"measured": {"linestyle": "-"},
         "simulated": {"linestyle": (0, (4, 2)), "linewidth": 1.2, "markersize": 5, "markerfacecolor": "none"}}
# Position of a legend to the right of its axes, where it hides no lines.
BESIDE = {"loc": "upper left", "bbox_to_anchor": (1, 1)}
GROWING = {"linewidth": 1.0, "markersize": 4}
REFINING = {"linestyle": "-.", "linewidth": 1.0, "markersize": 4}


def new_figure(columns=1, rows=1, width=9.0, height=3.8):
    """Returns a figure and its axes in a flat list. Uses no global state of pyplot."""
    figure = Figure(figsize=(width, height), layout="constrained")
    figure.patch.set_alpha(0)
    axes = list(numpy.ravel(figure.subplots(rows, columns)))
    for one in axes:
        dress(one)
    return figure, axes


def dress(axes):
    axes.patch.set_alpha(0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for spine in axes.spines.values():
        spine.set_color(INK)
    axes.tick_params(which="both", colors=INK, labelsize=9)
    axes.grid(True, color=PUBLISHED_GREY, alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)


def cores_axis(axes, cores):
    """Makes the axis logarithmic, with a tick at each power of two."""
    axes.set_xscale("log", base=2)
    top = int(numpy.ceil(numpy.log2(max([2, *cores]))))
    ticks = 2 ** numpy.arange(top + 1)
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.set_xlim(0.85, 2**top * 1.18)
    axes.set_xlabel("cores")


def by_algorithm(table):
    """Returns the parts of a table by algorithm, in the order of NAMES. Other meshers have no part."""
    return [(name, table.loc[[name]]) for name in NAMES if name in table.index]


def plot_published(axes, table, column, scale=1.0):
    """Draws the paper's series grey and dashed, behind everything else."""
    for algorithm, part in by_algorithm(table):
        axes.plot(part.index.get_level_values("cores"), part[column] * scale, color=PUBLISHED_GREY, linestyle="--",
                  linewidth=1.2, marker=MARKERS[algorithm], markersize=4, label=f"{NAMES[algorithm]}, paper", zorder=1)


def plot_series(axes, series, column, scale=1.0, of="", **options):
    """Draws our medians with their intervals: measured filled and solid, simulated hollow and dashed, thin if the image
    grows. `of` ends the words of the legend, `options` change the line."""
    options = {"linewidth": 1.8, "markersize": 6, "capsize": 3, **LINES[series.key["basis"]],
               **(GROWING if series.grows else {}), **options}
    for algorithm, part in by_algorithm(series.table):
        part = part[part[column].notna()]
        middle = part[column] * scale
        spread = numpy.nan_to_num([middle - part[column + "_low"] * scale, part[column + "_high"] * scale - middle])
        bars = numpy.clip(spread, 0, None) if part[column + "_low"].notna().any() else None
        axes.errorbar(part.index.get_level_values("cores"), middle, yerr=bars,
                      color=COLOURS[algorithm], zorder=3, label=f"{NAMES[algorithm]}, {series.kind()}{of}",
                      **{"marker": MARKERS[algorithm], **options})


def legend(axes, **options):
    made = axes.legend(frameon=False, fontsize=8, **options)
    for text in made.get_texts():
        text.set_color(INK)


def finish(figure, caption):
    """Sets sizes and colours of the labels. The caption becomes the figure's label, shown by write.py."""
    for axes in figure.axes:
        for text in (axes.title, axes.xaxis.label, axes.yaxis.label):
            text.set_color(INK)
            text.set_size(10)
    figure.set_label(caption)


def caption_of(series, has_paper=True):
    """Returns the description of the trials, their number, and, beside the paper's series, the meaning of the bars."""
    parts = []
    for one in series:
        counts = sorted(set(one.table["n"].astype(int)))
        n = f"n\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}{counts[0]}" + (f" to {counts[-1]}" if len(counts) > 1 else "")
        parts.append(f"{one.key['basis']}{', image grows' if one.grows else ''}: {one.label()}, {n}")
    text = "; ".join(parts) if parts else "no verified weak-scaling rows"
    beyond = BEYOND if any("podm-home" in one.table.index for one in series) else ""
    if not has_paper:
        return f"{text}.{beyond}"
    if any((one.table["n"] > 1).any() for one in series):
        text += (". Medians; bars: interval of order statistics over rounds or seeds, which holds the median with 95 % "
                 "from six values on")
    return f"{text}. Grey, dashed: the paper, Blacklight.{beyond}"
