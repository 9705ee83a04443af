"""Pareto fronts of all meshers and settings that meshed an image: seconds against cells and against the worst dihedral
angle. Rows of strangers' submissions count like others."""
import numpy
import pandas

from . import solvers, style
from .peers import version_of

GROUP = ["machine", "image", "cores"]
POINT = [*GROUP, "experiment", "setting", "maker"]
IMPROVING = ("perturb", "optimize", "exude")  # phases that improve angles; the paper's clock leaves them out
MOST_DRAWN = 3
COLUMNS = [*POINT, "n", "cells", "seconds", "least_deg", "microseconds_per_cell", "front_cells", "front_angle"]
NOTE = ("A mesh is on the front of cells if no other mesh of the image has at least as many cells in at most as many "
        "seconds. It is on the front of angles if no other mesh has a larger least dihedral angle and takes less time "
        "per cell. Seconds: the whole, from the image in memory to the mesh in memory, and the phases that improve "
        "angles. Medians of rows on one machine and one number of cores.")
PALETTE = ("#2b7bba", "#d1495b", "#3d8b5f", "#e8a33d", "#7a6c9d", "#8f575c", "#6d9dc5", "#4c6a5b", "#c9b458", "#8c8c8c")


def pareto(frame):
    """One line per mesher or setting of an image that at least two have meshed on one machine and number of cores."""
    rows = _comparable(frame)
    if rows.empty:
        return pandas.DataFrame(columns=COLUMNS)
    lines = [{**dict(zip(POINT, values)), "n": len(group), "cells": group["cells"].median(),
              "seconds": group["made_s"].median(), "least_deg": _median(group, "dihedral_deg.least")}
             for values, group in rows.groupby(POINT, sort=False)]
    points = pandas.DataFrame(lines)
    points["microseconds_per_cell"] = 1e6 * points["seconds"] / points["cells"]
    parts = [_with_fronts(group) for _, group in points.groupby(GROUP, sort=False) if group["maker"].nunique() > 1]
    return pandas.concat(parts, ignore_index=True)[COLUMNS] if parts else pandas.DataFrame(columns=COLUMNS)


def fronts(table):
    """The points on a front."""
    return table[table["front_cells"] | table["front_angle"]] if len(table) else table


def readable(table):
    shown = table[["image", "machine", "cores", "maker", "setting", "n"]].copy()
    shown["M cells"] = [f"{cells / 1e6:.3f}" for cells in table["cells"]]
    shown["seconds"] = [f"{seconds:.2f}" for seconds in table["seconds"]]
    shown["least dihedral angle"] = ["" if angle != angle else f"{angle:.2f}" for angle in table["least_deg"]]
    shown["µs per cell"] = [f"{value:.2f}" for value in table["microseconds_per_cell"]]
    shown["fronts"] = [", ".join(name for name in ("cells", "angle") if line[f"front_{name}"])
                       for line in table.to_dict("records")]
    return shown


def figure(frame):
    """Draws both fronts of the images with the most makers. None if no image has two."""
    table = pareto(frame)
    if table.empty:
        return None
    groups = sorted(table.groupby(GROUP, sort=False), key=lambda one: -one[1]["maker"].nunique())[:MOST_DRAWN]
    makers = sorted({maker for _, group in groups for maker in group["maker"]})
    colours = {maker: PALETTE[place % len(PALETTE)] for place, maker in enumerate(makers)}
    made, axes = style.new_figure(columns=len(groups), rows=2, width=4.2 * len(groups) + 2.4, height=7.2)
    grid = numpy.reshape(axes, (2, len(groups)))
    for column, ((_, image, cores), group) in enumerate(groups):
        title = f"{image}, {int(cores)} thread{'s' if cores > 1 else ''}"
        _draw(grid[0, column], group, colours, "cells", "seconds", "front_cells")
        grid[0, column].set(title=title, xscale="log", yscale="log", xlabel="cells", ylabel="seconds")
        _draw(grid[1, column], group.dropna(subset="least_deg"), colours, "least_deg", "microseconds_per_cell",
              "front_angle")
        grid[1, column].set(yscale="log", xlabel="least dihedral angle, degrees", ylabel="microseconds per cell")
    handles = {label: handle for one in axes for handle, label in zip(*one.get_legend_handles_labels())}
    style.legend(grid[0, -1], handles=list(handles.values()), labels=list(handles), **style.BESIDE)
    style.finish(made, NOTE)
    return made


def _comparable(frame):
    """Measured rows of finished meshes on any mesher, with their maker and seconds."""
    if frame.empty or "cells" not in frame:
        return frame.iloc[:0]
    rows = frame[(frame["basis"] == "measured") & (frame["status"] == "ok") & (frame["warmup"] != True)  # noqa: E712
                 & frame["cells"].gt(0) & frame["whole_s"].notna() & frame["cores"].notna()
                 & ~frame["moved"] & (frame["headline"] | (frame["mesher"] != "podm"))]
    improving = sum((rows[name].fillna(0) for name in (f"phases_s.{phase}" for phase in IMPROVING) if name in rows),
                    start=pandas.Series(0.0, rows.index))
    return rows.assign(maker=[_maker(row) for row in rows.to_dict("records")], made_s=rows["whole_s"] + improving)


def _maker(row):
    """Returns the mesher with its version, or podm's algorithm and the options that change its meshes."""
    if row["mesher"] != "podm":
        return f"{row['mesher']} ({version_of(row)})"
    words = [row.get("algorithm") or "podm"]
    if any(pandas.notna(row.get(f"asked.{key}")) for key in ("smooth", "smooth_voxels")):
        words.append("smooth")
    variant = solvers.variant_of(row)
    return ", ".join(words if variant == solvers.NONE else [*words, variant])


def _median(group, name):
    return group[name].median() if name in group else numpy.nan


def _with_fronts(group):
    cells, seconds = group["cells"].to_numpy(), group["seconds"].to_numpy()
    angle, cost = group["least_deg"].to_numpy(), group["microseconds_per_cell"].to_numpy()
    return group.assign(front_cells=_undominated(-cells, seconds),
                        front_angle=_undominated(-angle, cost) & ~numpy.isnan(angle.astype(float)))


def _undominated(first, second):
    """True for each point that no other point equals or beats in both values, which are better if smaller."""
    points = numpy.column_stack([first, second]).astype(float)
    return numpy.array([not any((other <= point).all() and (other < point).any() for other in points)
                        for point in points])


def _draw(axes, group, colours, x, y, front):
    for maker, part in group.groupby("maker", sort=True):
        axes.plot(part[x], part[y], linestyle="", marker="o", markersize=5, color=colours[maker], label=maker)
    on_front = group[group[front].astype(bool)].sort_values(x)
    axes.plot(on_front[x], on_front[y], color=style.PUBLISHED_GREY, linewidth=1.0, zorder=1)
