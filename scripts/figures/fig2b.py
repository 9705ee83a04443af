"""Figure 2 (b): two leaves refined at one time, with their first and second rings, over a cut through the mesh."""
import numpy
from matplotlib.collections import PolyCollection
from matplotlib.patches import Patch, Rectangle

from . import style
from .mesh import plane_cut
from .schedule import active_pair, rings

# Leaf, first ring, second ring of each of the two, as in the paper: green and red, paler outwards.
SHADES = [("#1b6e3c", "#58a773", "#b5dcc0"), ("#9b2335", "#d1495b", "#efb8be")]


def fig2b(schedule, mesh):
    """None when no two leaves of different nodes were active at one time."""
    pair = active_pair(schedule)
    if pair is None:
        return None
    *leaves, height = pair
    affine = schedule.mesh_to_grid
    polygons, owners = plane_cut(mesh.points @ affine[:, :3].T + affine[:, 3], mesh.cells, height)
    low, high, aspect = _frame(schedule)
    tall = aspect * (high[1] - low[1]) / (high[0] - low[0])
    figure, (axes,) = style.new_figure(width=8, height=0.9 + 5.8 * float(numpy.clip(tall, 0.3, 1.5)))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect=aspect, xlabel="i, leaf grid", ylabel="j, leaf grid",
             title=f"two active leaves, k = {height:g}")
    axes.grid(False)
    _draw_leaves(axes, schedule.leaves, leaves, height)
    axes.add_collection(PolyCollection(polygons, facecolors="none", edgecolors=style.INK, linewidths=0.25, alpha=0.6))
    style.legend(axes, handles=_handles(leaves), loc="upper left", bbox_to_anchor=(1, 1))
    first, second = (set(_with_ring(schedule.leaves, leaf)) for leaf in leaves)
    style.finish(figure, f"Cut at k = {height:g} of the leaf grid, {len(owners):,} cells cut. "
                  f"Leaves with first rings have {len(first & second)} leaves in common.")
    return figure


def _with_ring(leaves, leaf):
    return [leaf, *rings(leaves, leaf)[0]]


def _draw_leaves(axes, leaves, active, height):
    cut = (leaves[:, 2] <= height) & (height < leaves[:, 2] + leaves[:, 3])
    colours = {}
    for leaf, (dark, middle, pale) in zip(active, SHADES):
        first, second = rings(leaves, leaf)
        colours.update({one: pale for one in second if one not in colours})
        colours.update({one: middle for one in first})
    colours.update({leaf: shades[0] for leaf, shades in zip(active, SHADES)})
    for one in numpy.flatnonzero(cut):
        i, j, _, side = leaves[one]
        axes.add_patch(Rectangle((i, j), side, side, facecolor=colours.get(one, "none"), alpha=0.85, linewidth=0.8,
                                 edgecolor=style.GHOST))


def _frame(schedule):
    """Corners of the plane's leaves, and how much longer a step of j is than one of i in mm."""
    leaves = schedule.leaves
    step_mm = numpy.linalg.norm(numpy.linalg.inv(schedule.mesh_to_grid[:, :3]), axis=0)
    return leaves[:, :2].min(axis=0), (leaves[:, :2] + leaves[:, 3:]).max(axis=0), step_mm[1] / step_mm[0]


def _handles(leaves):
    words = ("leaf", "first ring of", "second ring of")
    return [Patch(color=shade, label=f"{word} {leaf}")
            for leaf, shades in zip(leaves, SHADES) for word, shade in zip(words, shades)]
