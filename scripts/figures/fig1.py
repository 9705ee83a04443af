"""Figure 1: quality. Histograms from reports of podm-verify (`--json`); without a report, the extremes in the rows.

`podm view` renders the mesh.
"""
import numpy

from . import scaling, style

RADIUS_EDGE, ANGLE_DEG = 1.93, 30.0  # guarantees: below the first, above the second
PANELS = [  # name of the histogram, title, axis, guarantee
    ("radius_edge_ratio", "radius-edge ratio of cells", "circumradius / shortest edge", RADIUS_EDGE),
    ("boundary_facet_angle", "angles of boundary facets", "degrees", ANGLE_DEG),
    ("dihedral_angle", "dihedral angles", "degrees", None),
]


def fig1(report):
    """Draws the histograms of a report of podm-verify; None if it holds no histogram."""
    histograms = {one["name"]: one for claim in report["claims"].values() for one in claim["histograms"]}
    panels = [panel for panel in PANELS if panel[0] in histograms]
    if not panels:
        return None
    figure, axes = style.new_figure(columns=len(panels))
    for one, (name, title, unit, bound) in zip(axes, panels):
        histogram = histograms[name]
        counts = numpy.asarray(histogram["counts"], dtype=float)
        edges = numpy.linspace(histogram["low"], histogram["high"], len(counts) + 1)
        one.stairs(100 * counts / max(counts.sum(), 1), edges, fill=True, color=style.COLOURS["podm"], alpha=0.85)
        if bound is not None:
            one.axvline(bound, color=style.PUBLISHED_GREY, linestyle="--")
        one.set(title=f"{title}\n{histogram['minimum']:.4g} to {histogram['maximum']:.4g}", xlabel=unit,
                ylabel="% of all")
    mesh = report["mesh"]
    style.finish(figure, f"{mesh['cells']:,} cells, counted exactly by podm-verify. Lines: guarantees of the method; "
                          "dihedral angles have none.")
    return figure


def fig1_extremes(frame):
    """Draws the worst cell and boundary facet of each verified row against the guarantees; None without such rows."""
    rows = scaling.headline_rows(frame)
    if rows.empty or "quality.max_radius_edge" not in rows:
        return None
    rows = rows.dropna(subset=["quality.max_radius_edge", "quality.min_facet_angle_deg"])
    if rows.empty:
        return None
    figure, axes = style.new_figure(columns=2)
    for one, column, title, bound in (
        (axes[0], "quality.max_radius_edge", "worst radius-edge ratio", RADIUS_EDGE),
        (axes[1], "quality.min_facet_angle_deg", "smallest boundary angle, degrees", ANGLE_DEG),
    ):
        one.plot(rows["cells"] / 1e6, rows[column], "o", color=style.COLOURS["podm"], alpha=0.75)
        one.axhline(bound, color=style.PUBLISHED_GREY, linestyle="--")
        one.set(title=title, xlabel="million cells", xscale="log")
        one.margins(y=0.4)
    style.finish(figure, f"n = {len(rows)} verified meshes, every one shown. Lines: guarantees of the method.")
    return figure
