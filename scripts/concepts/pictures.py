"""Draws what a run does: its mesh after numbers of operations, single operations, and two that conflict."""
import itertools

import numpy
from figures import style
from matplotlib.collections import PolyCollection
from views.colours import PALETTE

from .operation_log import CIRCUMCENTER, ISOSURFACE
from .triangulation import Plane, Triangulation

BEFORE, AFTER, OTHER, POINT, GONE = "#f2c48d", "#a9cbe8", "#cfe3c3", "#b3303f", "#1f2430"


def _colour_of(label):
    return "none" if label == 0 else PALETTE[int(label) % len(PALETTE)]


def _finish(figure, axes, extent):
    for one in axes:
        one.set_xlim(*extent[0])
        one.set_ylim(*extent[1])
        one.set_aspect("equal")
        one.set_xticks([])
        one.set_yticks([])
        one.grid(False)
        for spine in one.spines.values():
            spine.set_visible(True)
            spine.set_linewidth(0.4)
    figure.patch.set(alpha=1, facecolor="white")  # the ink is dark on dark pages, too


def refinement(log, labels, shares=(0.01, 0.05, 0.25, 1)):
    """The mesh after these shares of the operations, cut by the plane z = 0."""
    figure, axes = style.new_figure(columns=2, rows=2, width=10, height=7.4)
    plane = Plane(numpy.zeros(3), numpy.array([1.0, 0, 0]), numpy.array([0, 1.0, 0]))
    for one, share in zip(axes, shares):
        number = round(share * len(log.operations))
        mesh = Triangulation.of(log.vertices_before(number))
        polygons, owners = plane.cut(mesh, numpy.ones(len(mesh.cells), bool))
        colours = [_colour_of(label) for label in labels.at(mesh.spheres()[0])[owners]]
        one.add_collection(PolyCollection(polygons, facecolors=colours, edgecolors=style.INK, linewidths=0.3))
        one.set_title(f"after {number:,} operations", fontsize=10)
    half = -labels.inverse[:3, 3] @ numpy.linalg.inv(labels.inverse[:3, :3]).T
    reach = 1.15 * numpy.abs(half[:2])
    _finish(figure, axes, [(-reach[0], reach[0]), (-reach[1], reach[1])])
    return figure


def operations(log, labels):
    """An isosurface insertion, a circumcenter insertion, and an insertion with removals: before and after."""
    found = [_example(log, lambda one: one["kind"] == ISOSURFACE and one["num_removed"] == 0),
             _example(log, lambda one: one["kind"] == CIRCUMCENTER),
             _example(log, lambda one: one["kind"] == ISOSURFACE and one["num_removed"] == 1)]
    titles = ["R1, R3: a point of the isosurface is inserted", "R2, R4, R5: a circumcenter is inserted",
              "R6: an isosurface point removes a circumcenter near it"]
    figure, axes = style.new_figure(columns=2, rows=3, width=8, height=11)
    for row, (number, title) in enumerate(zip(found, titles)):
        _draw_operation(axes[2 * row:2 * row + 2], log, labels, number, title)
    return figure


def _example(log, is_wanted):
    """The number of the first such operation in the second half of the run; the image's surface is near by then."""
    half = len(log.operations) // 2
    return next(number for number in itertools.chain(range(half, len(log.operations)), range(half - 1, 0, -1))
                if is_wanted(log.operations[number]))


def _draw_operation(axes, log, labels, number, title):
    operation, removed = log.operations[number], log.removed[number]
    vertices = log.vertices_before(number)
    before, after = Triangulation.of(vertices), Triangulation.of(log.vertices_before(number + 1))
    point = operation["point"]
    old = before.cavity(point, before.spheres(), removed)
    kept = before.named_cells(numpy.ones(len(old), bool))
    new = numpy.array([frozenset(cell) not in kept for cell in after.ids[after.cells].tolist()])
    gone = numpy.array([vertices[int(one)] for one in removed])
    plane = _plane_at(point, gone)
    reach = 1.3 * numpy.abs(plane.cut(before, old)[0]).max()
    for one, mesh, chosen, colour in zip(axes, (before, after), (old, new), (BEFORE, AFTER)):
        _draw_labels(one, labels, plane, reach)
        _draw_cells(one, mesh, plane, chosen, colour)
        one.plot(0, 0, "o", color=POINT, markersize=6)
    if len(gone):
        axes[0].plot(*plane.seen(gone)[:, :2].T, "x", color=GONE, markersize=8, markeredgewidth=2)
    axes[0].set_title(f"{title}\nbefore: {old.sum()} cells", fontsize=9)
    axes[1].set_title(f"after: {new.sum()} cells", fontsize=9)
    _finish(axes[0].figure, axes, [(-reach, reach), (-reach, reach)])


def _plane_at(point, others):
    """Through the point and the first of the others, as level as this allows."""
    right = others[0] - point if len(others) else numpy.array([1.0, 0, 0])
    return Plane.through(point, point + right, point + numpy.cross([0, 0, 1.0], right))


def _draw_labels(axes, labels, plane, reach):
    """The lines where the image's label changes in the plane."""
    steps = numpy.linspace(-reach, reach, 300)
    x, y = numpy.meshgrid(steps, steps)
    values = labels.at(plane.origin + x[..., None] * plane.right + y[..., None] * plane.up)
    for label in numpy.unique(values):
        axes.contour(x, y, values == label, levels=[0.5], colors="#8a6d3b", linewidths=1.6, linestyles=":")


def _draw_cells(axes, mesh, plane, chosen, colour):
    for which, face, width in ((~chosen, "none", 0.3), (chosen, colour, 0.9)):
        polygons, _ = plane.cut(mesh, which)
        axes.add_collection(PolyCollection(polygons, facecolors=face, edgecolors=style.INK, linewidths=width,
                                           alpha=0.85))


def conflict(log, window=40):
    """Two operations of different workers, near each other in the order of commits, whose regions share vertices."""
    mesh, spheres, (first, second), (one_region, other_region), shared = _pair(log, window)
    points = [log.operations[number]["point"] for number in (first, second)]
    where = mesh.points[mesh.ids == shared[0]][0]
    plane = Plane.through(where, points[0], points[1])
    figure, (axes,) = style.new_figure(width=7, height=5.6)
    rest = ~(one_region | other_region)
    for chosen, colour in ((rest, "none"), (one_region, BEFORE), (other_region, AFTER)):
        polygons, _ = plane.cut(mesh, chosen)
        axes.add_collection(PolyCollection(polygons, facecolors=colour, edgecolors=style.INK,
                                           linewidths=0.3 if colour == "none" else 0.9, alpha=0.85))
    for number, point in zip((first, second), points):
        x, y, _ = plane.seen(point)
        axes.plot(x, y, "o", color=POINT, markersize=6)
        axes.annotate(f"worker {log.operations[number]['worker']}", (x, y), xytext=(6, 6), textcoords="offset points")
    axes.plot(0, 0, "s", color=GONE, markersize=8, markerfacecolor="none", markeredgewidth=2)
    axes.set_title(f"operations {first:,} and {second:,}: {len(shared)} vertices in common, one of them in this cut",
                   fontsize=10)
    spots = numpy.concatenate([plane.cut(mesh, region)[0] for region in (one_region, other_region)]).reshape(-1, 2)
    (x, y), reach = (spots.min(axis=0) + spots.max(axis=0)) / 2, 0.62 * numpy.ptp(spots, axis=0).max()
    _finish(figure, [axes], [(x - 1.2 * reach, x + 1.2 * reach), (y - reach, y + reach)])
    return figure


def _pair(log, window):
    """The first pair whose regions have vertices but no cells in common, in the last tenth of the run or before."""
    for start in range(int(0.9 * len(log.operations)), 0, -window):
        vertices = log.vertices_before(start)
        mesh = Triangulation.of(vertices)
        spheres = mesh.spheres()
        numbers = [number for number in range(start, min(start + window, len(log.operations)))
                   if set(log.removed[number].tolist()) <= set(vertices)]
        regions = {number: mesh.cavity(log.operations[number]["point"], spheres, log.removed[number])
                   for number in numbers}
        for first, second in itertools.combinations(numbers, 2):
            if log.operations[first]["worker"] == log.operations[second]["worker"]:
                continue
            one, other = regions[first], regions[second]
            shared = sorted(set(mesh.ids[mesh.cells[one]].ravel()) & set(mesh.ids[mesh.cells[other]].ravel()))
            if shared and not (one & other).any():
                return mesh, spheres, (first, second), (one, other), shared
    raise ValueError("no two operations of different workers are near each other")
