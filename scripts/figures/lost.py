"""Shows where the time of simulated workers goes: worker seconds per cell by cause, against cores. If workers lost no
time to each other, all bars would be as high as the bar of one core."""
import pandas

from . import scaling, style

PREFIX = "virtual.worker_s."
# From work to losses to other workers, in the order of the stack. Unknown causes are inserted before the last.
CAUSES = {"compute": "computing", "memory_remote": "memory of other nodes", "network_queue": "queueing in the network",
          "between_attempts": "lists, gifts, leaves", "locks": "waiting for locks",
          "contention": "waiting after conflicts", "rollback": "rolling back", "begging": "begging, waiting for leaves",
          "outside": "outside refinement, or idle"}
COLOURS = dict(zip(CAUSES, ["#8fb996", "#e8a33d", "#d1495b", "#c9b458", "#7a6c9d", "#8f575c", "#3d3d6b", "#6d9dc5",
                            style.PUBLISHED_GREY]))
OTHER_COLOUR = "#e6d5e8"
COLUMNS = ["basis", "kind", "algorithm", "cores", "n"]


def lost(frame, series):
    """One line per algorithm and number of cores of the simulated series to show: median worker microseconds per cell
    by cause. `outside`: the time of all cores in equation 1 that no cause has. Empty if rows have no causes."""
    shown = scaling.first_of(series, "simulated")
    causes = sorted((name.removeprefix(PREFIX) for name in frame if name.startswith(PREFIX)),
                    key=lambda cause: list(CAUSES).index(cause) if cause in CAUSES else len(CAUSES))
    if shown is None or not causes:
        return pandas.DataFrame(columns=COLUMNS)
    rows = scaling.rows_of(frame, shown).dropna(subset=PREFIX + causes[0])
    lines = []
    for (algorithm, cores), group in rows.groupby(["algorithm", "cores"]):
        by_cause = group[[PREFIX + cause for cause in causes]].div(group["cells"], axis=0)
        whole = group["seconds"] * cores / group["cells"]
        outside = (whole - by_cause.sum(axis=1)).clip(lower=0)
        seconds = {**dict(zip(causes, by_cause.median())), "outside": outside.median()}  # per cell
        lines.append({"basis": "simulated", "kind": shown.kind(), "algorithm": algorithm, "cores": cores,
                      "n": len(group), **{cause: 1e6 * one for cause, one in seconds.items()}})
    return pandas.DataFrame(lines)


def _causes(table):
    """Returns (cause, readable name) in the order of the stack."""
    return [(cause, CAUSES.get(cause, cause.replace("_", " "))) for cause in table.columns[len(COLUMNS):]]


def readable(table):
    """Worker microseconds per cell, with three digits."""
    shown = table[["algorithm", "cores", "kind"]].rename(columns={"kind": "basis"})
    for cause, words in _causes(table):
        shown[words] = ["" if pandas.isna(value) else f"{value:.3g}" for value in table[cause]]
    return shown


def figure(frame, series):
    """Draws stacked bars, one panel per algorithm with one scale; None if rows have no causes."""
    table = lost(frame, series)
    if table.empty:
        return None
    parts = style.by_algorithm(table.set_index("algorithm"))
    drawn, panels = style.new_figure(columns=len(parts), width=2.5 + 4 * len(parts), height=4.2)
    cores = sorted(set(table["cores"]))
    for axes, (algorithm, part) in zip(panels, parts):
        places, bottoms = [cores.index(count) for count in part["cores"]], 0 * part["cores"].astype(float)
        for cause, words in _causes(table):
            heights = part[cause].fillna(0)
            axes.bar(places, heights, 0.7, bottom=bottoms, color=COLOURS.get(cause, OTHER_COLOUR), label=words,
                     edgecolor=style.INK, linewidth=0.3)
            bottoms = bottoms + heights
        axes.set_xticks(range(len(cores)), [str(count) for count in cores])
        axes.set_xlim(-0.6, len(cores) - 0.4)
        axes.set(xlabel="simulated cores", ylabel="simulated worker microseconds per cell",
                 title=style.NAMES[algorithm])
    top = 1.05 * max(axes.dataLim.y1 for axes in panels)
    for axes in panels:
        axes.set_ylim(0, top)
    handles, labels = panels[-1].get_legend_handles_labels()
    style.legend(panels[-1], handles=handles[::-1], labels=labels[::-1], **style.BESIDE)
    shown = scaling.first_of(series, "simulated")
    style.finish(drawn, f"Where the time goes: {style.caption_of([shown], has_paper=False)}")
    return drawn
