"""Histograms of dihedral angles before and after the two stages against slivers (solvers.toml)."""
import numpy

from . import solvers, style

SHOWN = (solvers.NONE, solvers.MOVED, solvers.BOTH)


def figure(frame):
    """Draws the angles by image, in bins of one degree. None unless an image has rows without options and after a
    stage."""
    found = {}
    for image, groups in solvers.rows_by_variant(frame, "dihedral_deg.least").items():
        rows = {variant: group.iloc[-1] for variant, group in groups.items() if variant in SHOWN}
        if solvers.NONE in rows and len(rows) > 1:
            found[image] = rows
    if not found:
        return None
    made, axes = style.new_figure(columns=len(found), width=4.2 * len(found) + 1.6, height=3.8)
    for one, (image, rows) in zip(axes, found.items()):
        for variant, row in rows.items():
            counts = numpy.asarray(row["dihedral_deg.counts"], dtype=float)
            one.stairs(counts * 1e6 / row["cells"], numpy.arange(len(counts) + 1), baseline=None, linewidth=1.4,
                       color=solvers.COLOURS[variant],
                       label=f"{variant}: {row['dihedral_deg.least']:.2f} to {row['dihedral_deg.largest']:.2f}")
        for bound in (solvers.SMALL_DEG, solvers.LARGE_DEG):
            one.axvline(bound, color=style.PUBLISHED_GREY, linestyle="--", linewidth=0.8)
        one.set(title=f"{image}, {rows[solvers.NONE]['cells'] / 1e6:.2f} million cells", yscale="log", xlim=(0, 180),
                ylim=(0.5, None), xlabel="dihedral angle, degrees", ylabel="angles per degree and million cells")
        one.set_xticks(range(0, 181, 30))
        style.legend(one, loc="lower center")
    style.finish(made, f"Counted by podm-verify, six angles per cell. Lines: {solvers.SMALL_DEG} and "
                       f"{solvers.LARGE_DEG} degrees, the bounds of both stages.")
    return made
