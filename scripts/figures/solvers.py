"""The cost of meshes with and without slivers for a solver: iterations of conjugate gradients (solvers.toml)."""
import numpy
import pandas

from . import style
from .peers import misses_of

# The program or options that made a mesh, in the order of tables and legends; the first four are podm's.
NONE, MOVED, BOTH, OPTIMIZED = "no option", "R7", "both stages", "stage 2 alone"
PEERS = {"tetgen": "TetGen", "gmsh": "Gmsh's HXT", "cgal_exuded": "CGAL, perturbed and exuded"}
VARIANTS = (NONE, MOVED, OPTIMIZED, BOTH, *PEERS.values())
COLOURS = {NONE: "#8c8c8c", MOVED: "#7fb3d5", OPTIMIZED: "#b39ddb", BOTH: "#2b7bba", "TetGen": "#e8a33d",
           "Gmsh's HXT": "#3d8b5f", "CGAL, perturbed and exuded": "#d1495b"}
SYSTEMS = {"poisson": "Poisson", "elasticity": "elasticity"}
PRECONDITIONERS = {"jacobi": "Jacobi", "amg": "algebraic multigrid"}
SMALL_DEG, LARGE_DEG = 8, 165
COLUMNS = ["image", "variant", "n", "cells", "least_deg", "largest_deg", "small_per_million", "large_per_million",
           *(f"{system}_{preconditioner}" for system in SYSTEMS for preconditioner in PRECONDITIONERS),
           *(f"{system}_largest_eigenvalue" for system in SYSTEMS), "misses"]


def rows_by_variant(frame, needed):
    """Returns finished rows with the column `needed`: by image the rows of each variant's largest mesh, in the order of
    VARIANTS. Rows of other meshers count even if they miss a promised claim."""
    if needed not in frame:
        return {}
    is_finished = (frame["status"] == "ok") | (frame["mesher"] != "podm") & (frame["status"] == "unmet")
    rows = frame[frame[needed].notna() & is_finished & ~frame["warmup"].astype(bool)]
    rows = rows.assign(variant=[variant_of(row) for _, row in rows.iterrows()])
    found = {}
    for image, of_image in rows[rows["basis"] == "measured"].groupby("image", sort=True):
        groups = {}
        for variant in VARIANTS:
            group = of_image[of_image["variant"] == variant]
            if len(group):
                largest = group.loc[group["cells"].idxmax(), "setting"]
                groups[variant] = group[group["setting"] == largest]
        if groups:
            found[image] = groups
    return found


def solvers(frame):
    """One line per image and variant. Values are medians of repeats, which are all equal on one machine."""
    lines = []
    for image, groups in rows_by_variant(frame, "solve.poisson.jacobi.iterations").items():
        for variant, group in groups.items():
            lines.append({"image": image, "variant": variant, **_line(group)})
    return pandas.DataFrame(lines, columns=COLUMNS)


def readable(table):
    shown = table[["image", "variant"]].copy()
    shown["M cells"] = [f"{cells / 1e6:.2f}" for cells in table["cells"]]
    shown["dihedral angles"] = [f"{least:.2f} to {largest:.2f}"
                                for least, largest in zip(table["least_deg"], table["largest_deg"])]
    for name, words in (("small", f"below {SMALL_DEG}"), ("large", f"above {LARGE_DEG}")):
        shown[f"{words}, per million cells"] = [f"{number:.0f}" for number in table[f"{name}_per_million"]]
    for system, system_name in SYSTEMS.items():
        for preconditioner, name in PRECONDITIONERS.items():
            shown[f"{system_name}, {name}"] = [f"{number:.0f}" for number in table[f"{system}_{preconditioner}"]]
        shown[f"{system_name}, largest eigenvalue"] = [f"{value:.2f}"
                                                       for value in table[f"{system}_largest_eigenvalue"]]
    shown["claims missed"] = table["misses"]
    return shown


def figure(frame):
    """Draws the iterations by image, system and preconditioner. None without rows that were solved."""
    table = solvers(frame)
    if table.empty:
        return None
    images = list(dict.fromkeys(table["image"]))
    made, axes = style.new_figure(columns=len(images), rows=len(PRECONDITIONERS), width=4.2 * len(images) + 1.6,
                                  height=5.6)
    grid = numpy.reshape(axes, (len(PRECONDITIONERS), len(images)))
    for line, (preconditioner, name) in zip(grid, PRECONDITIONERS.items()):
        for one, image in zip(line, images):
            _draw_bars(one, table[table["image"] == image], preconditioner)
            one.set(title=f"{image}: {name}", ylabel="iterations")
    style.legend(grid[0, -1], **style.BESIDE)
    style.finish(made, "Conjugate gradients until the residual is 1e-8 of the first, P1 elements, 0 on the outer "
                       "boundary; meshes beside each other have about the same number of cells.")
    return made


def variant_of(row):
    if row["mesher"] != "podm":
        return PEERS.get(row["mesher"], row["mesher"])
    moves = pandas.notna(row.get("asked.min_dihedral"))
    optimizes = row.get("asked.optimize") is True
    return {(False, False): NONE, (True, False): MOVED, (False, True): OPTIMIZED, (True, True): BOTH}[moves, optimizes]


def _line(group):
    line = {"n": len(group), "cells": group["cells"].median(), "misses": ", ".join(misses_of(group))}
    for system in SYSTEMS:
        for preconditioner in PRECONDITIONERS:
            line[f"{system}_{preconditioner}"] = group[f"solve.{system}.{preconditioner}.iterations"].median()
        line[f"{system}_largest_eigenvalue"] = group[f"solve.{system}.jacobi.largest_eigenvalue"].median()
    if "dihedral_deg.counts" in group and group["dihedral_deg.counts"].notna().all():
        newest = group.iloc[-1]
        counts, millions = numpy.asarray(newest["dihedral_deg.counts"]), newest["cells"] / 1e6
        line.update(least_deg=newest["dihedral_deg.least"], largest_deg=newest["dihedral_deg.largest"],
                    small_per_million=counts[:SMALL_DEG].sum() / millions,
                    large_per_million=counts[LARGE_DEG:].sum() / millions)
    return line


def _draw_bars(axes, table, preconditioner):
    width = 0.8 / max(len(table), 1)
    places = numpy.arange(len(SYSTEMS))
    for number, (_, line) in enumerate(table.iterrows()):
        heights = [line[f"{system}_{preconditioner}"] for system in SYSTEMS]
        axes.bar(places - 0.4 + (number + 0.5) * width, heights, width, color=COLOURS[line["variant"]],
                 label=line["variant"])
    axes.set_xticks(places, SYSTEMS.values())
