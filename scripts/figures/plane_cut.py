"""Plane cuts through tetrahedra."""
import numpy


def plane_cut(points, cells, height):
    """Returns the polygons in which z = `height` cuts the cells, and the index of the cell of each. Polygons are k x 4
    x 2 (x and y); triangles repeat their last corner. Vertices on the plane count as above it."""
    above = points[cells, 2] >= height
    triangles = _cut_by(points, cells, above, height, 1) + _cut_by(points, cells, ~above, height, 1)
    quads = _cut_by(points, cells, above, height, 2)
    polygons = numpy.concatenate([polygon for polygon, _ in triangles + quads])
    return polygons, numpy.concatenate([cell for _, cell in triangles + quads])


def _cut_by(points, cells, chosen, height, count):
    """Cuts the cells with `count` chosen vertices: the cut crosses the edges from these to the other vertices."""
    found = numpy.flatnonzero(chosen.sum(axis=1) == count)
    if found.size == 0:
        return [(numpy.empty((0, 4, 2)), found)]
    order = numpy.argsort(~chosen[found], axis=1, kind="stable")  # chosen vertices first
    corners = points[numpy.take_along_axis(cells[found], order, axis=1)]
    # Around the cut, consecutive edges share a vertex of the cell.
    edges = [(0, 1), (0, 2), (0, 3), (0, 3)] if count == 1 else [(0, 2), (0, 3), (1, 3), (1, 2)]
    polygon = [_cross(corners[:, a], corners[:, b], height) for a, b in edges]
    return [(numpy.stack(polygon, axis=1), found)]


def _cross(start, end, height):
    share = (height - start[:, 2]) / (end[:, 2] - start[:, 2])
    return start[:, :2] + share[:, None] * (end[:, :2] - start[:, :2])
