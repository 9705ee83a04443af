"""Figure 2 (b): two leaves refined at the same time, with their first and second rings, over a cut through the mesh."""
import numpy
from matplotlib.collections import PolyCollection
from matplotlib.patches import Patch, Rectangle

from . import style
from .plane_cut import plane_cut
from .schedule import active_pair, rings

# Leaf, first ring and second ring of each of the two leaves, as in the paper: green and red, paler outwards.
SHADES = [("#1b6e3c", "#58a773", "#b5dcc0"), ("#9b2335", "#d1495b", "#efb8be")]
LEAF, FIRST, SECOND = range(3)
MARGIN = 0.08  # around the grid, in leaves


def fig2b(schedule, mesh):
    """Draws the figure; None if no two leaves of different nodes were active at the same time."""
    pair = active_pair(schedule)
    if pair is None:
        return None
    *turns, height = pair
    affine = schedule.mesh_to_grid
    polygons, owners = plane_cut(mesh.points @ affine[:, :3].T + affine[:, 3], mesh.cells, height)
    low, high, aspect = _frame(schedule)
    tall = aspect * (high[1] - low[1]) / (high[0] - low[0])
    figure, (axes,) = style.new_figure(width=8, height=0.9 + 5.8 * float(numpy.clip(tall, 0.3, 1.5)))
    axes.set(xlim=(low[0] - MARGIN, high[0] + MARGIN), ylim=(low[1] - MARGIN, high[1] + MARGIN), aspect=aspect,
             xlabel="i, leaf grid", ylabel="j, leaf grid", title="two leaves refined at the same time, and their rings")
    axes.grid(False)
    axes.spines[:].set_visible(False)
    zones = [_zones(schedule.leaves, turn["leaf"]) for turn in turns]
    _draw_leaves(axes, schedule.leaves, zones, height)
    axes.add_collection(PolyCollection(polygons, facecolors="none", edgecolors=style.INK, linewidths=0.25, alpha=0.6))
    style.legend(axes, handles=_handles(turns), loc="upper left", bbox_to_anchor=(1, 1))
    style.finish(figure, _caption(turns, zones, height, len(owners)))
    return figure


def _zones(leaves, leaf):
    """Returns LEAF, FIRST or SECOND by leaf."""
    first, second = rings(leaves, leaf)
    return {leaf: LEAF, **dict.fromkeys(first, FIRST), **dict.fromkeys(second, SECOND)}


def _draw_leaves(axes, leaves, zones, height):
    """Draws each leaf in the colour of the nearer active leaf; hatched in the other colour if it is in the rings of
    both."""
    for one in numpy.flatnonzero((leaves[:, 2] <= height) & (height < leaves[:, 2] + leaves[:, 3])):
        i, j, _, side = leaves[one]
        here = [(zone[one], shades) for zone, shades in zip(zones, SHADES) if one in zone]
        colours = [shades[ring] for ring, shades in sorted(here, key=lambda each: each[0])]
        colour = colours[0] if colours else "none"
        axes.add_patch(Rectangle((i, j), side, side, facecolor=colour, alpha=0.85, linewidth=0))
        if len(colours) > 1:
            axes.add_patch(Rectangle((i, j), side, side, fill=False, hatch="//", edgecolor=colours[1], linewidth=0))
        axes.add_patch(Rectangle((i, j), side, side, fill=False, edgecolor=style.PUBLISHED_GREY, linewidth=0.8))


def _frame(schedule):
    """Returns the corners of the plane's leaves, and the length in mm of a step of j over that of a step of i."""
    leaves = schedule.leaves
    step_mm = numpy.linalg.norm(numpy.linalg.inv(schedule.mesh_to_grid[:, :3]), axis=0)
    return leaves[:, :2].min(axis=0), (leaves[:, :2] + leaves[:, 3:]).max(axis=0), step_mm[1] / step_mm[0]


def _handles(turns):
    words = ("leaf {leaf}, node {node}", "its first ring", "its second ring")
    return [Patch(color=shade, label=word.format(**turn))
            for turn, shades in zip(turns, SHADES) for word, shade in zip(words, shades)]


def _caption(turns, zones, height, num_cut):
    begin, end = max(1e3 * turn["begin_s"] for turn in turns), min(1e3 * turn["end_s"] for turn in turns)
    inner = [{leaf for leaf, zone in one.items() if zone != SECOND} for one in zones]
    common = len(inner[0] & inner[1])
    return (f"Both active from {begin:.2f} to {end:.2f} ms of the refinement. Leaves with their first rings have "
            f"{common or 'no'} leaf in common; hatched: also in the second ring of the other. Cut at "
            f"k\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}{height:g} of the leaf grid through {num_cut:,} cells of the final "
            "mesh.")
