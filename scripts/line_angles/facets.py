"""Facets of a mesh between two labels, and those of them at a line: with an edge around which three labels meet."""
import numpy


def interface_facets(cells, labels):
    """Returns the vertices of facets between two labels, and these labels; 0 is outside the mesh."""
    facets = numpy.concatenate([numpy.delete(cells, i, axis=1) for i in range(4)])
    owners = numpy.tile(labels, 4)
    unique, first, number = numpy.unique(numpy.sort(facets, axis=1), axis=0, return_index=True, return_inverse=True)
    sums = numpy.bincount(number.reshape(-1), weights=owners).astype(int)
    sides = numpy.stack([owners[first], sums - owners[first]], axis=1)
    is_interface = sides[:, 0] != sides[:, 1]
    return unique[is_interface], sides[is_interface]


def are_at_lines(facets, sides):
    """True for each facet with an edge around which its facets have three labels or more on their sides."""
    edges = numpy.sort(numpy.concatenate([facets[:, [0, 1]], facets[:, [0, 2]], facets[:, [1, 2]]]), axis=1)
    _, edge = numpy.unique(edges, axis=0, return_inverse=True)
    edge = edge.reshape(-1)
    of_edges = numpy.unique(numpy.stack([numpy.repeat(edge, 2), numpy.tile(sides, (3, 1)).reshape(-1)], axis=1), axis=0)
    is_line = numpy.bincount(of_edges[:, 0]) >= 3
    return is_line[edge].reshape(3, -1).any(axis=0)


def areas_and_normals(points, facets):
    """Returns the areas of facets, and their unit normals."""
    a, b, c = (points[facets[:, i]] for i in range(3))
    cross = numpy.cross(b - a, c - a)
    twice = numpy.linalg.norm(cross, axis=1)
    return twice / 2, cross / twice[:, None]


def errors_deg(normals, true_normals):
    """Returns the angles between lines along the normals, degrees."""
    cosines = numpy.abs(numpy.sum(normals * true_normals, axis=1)).clip(0, 1)
    return numpy.degrees(numpy.arccos(cosines))
