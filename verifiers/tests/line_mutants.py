"""Mutation operators of lines where three or more labels meet, and of the bounds near them.

Voxels are [z, y, x]. In meshes of voxels the center of voxel (0, 0, 0) is at (0.5, 0.5, 0.5), so that vertices have
whole coordinates.
"""

import itertools
import math

import numpy as np

from medit_mesh import MeditMesh
from mutants import Case, Mutant, joined, operator
from tolerance_mutants import BALL_CENTER, BALL_RADIUS, BEYOND, VERTEX_BOUND, WITHIN, image_of, meshed
from topology_mutants import OPERATORS, case, changed

__all__ = ["OPERATORS"]

LEAST_NEAR_LINES = math.degrees(math.asin(math.sqrt(1 / 8)))  # 20.7
HALF_A_BOX = 0.5 * 0.54 ** 5 * math.sqrt(3)  # which the claim lines adds to its bound, voxels


def promising(delta):
    return [f"# promise lines {delta}\n"]


def quadrants():
    """Four labels around the line x = 6, y = 5."""
    voxels = np.ones((7, 10, 12), dtype=int)
    voxels[:, :, 6:] += 1
    voxels[:, 5:] += 2
    return voxels


def with_line_vertex_moved(fixture, by, delta):
    """Returns the mesh of the quadrants with the vertex (6, 5, 3) moved."""
    moved = case(fixture, quadrants(), quadrants(), promising(delta))
    moved.mesh.vertices[(moved.mesh.vertices == (6, 5, 3)).all(axis=1)] += by
    return moved


@operator("lines")
def line_moved_by_a_label(fixture):
    """a voxel beside a line with the label across it, which moves the line; harmless: a voxel away from lines"""
    image = quadrants()

    def relabelled(x, y, z):
        return case(fixture, image, changed(image, {(x, y, z): 2}), promising(1))
    return Mutant(relabelled(5, 4, 3), relabelled(5, 2, 3), ("structure", "surface"))


def sectors():
    """Three labels around the line x = 6, y = 5, or 0.17 voxels from it."""
    return np.minimum(quadrants(), 3) - (quadrants() == 3) * 2


@operator("lines")
def line_edge_relabelled(fixture):
    """an edge of a line with the cells of one of its labels relabelled; harmless: an edge of an interface"""
    def at(y):
        mesh = case(fixture, sectors(), sectors(), promising(1))
        ends = [np.flatnonzero((mesh.mesh.vertices == (6, y, z)).all(axis=1))[0] for z in (3, 4)]
        around = np.isin(mesh.mesh.cells[:, :4], ends).sum(axis=1) == 2
        mesh.mesh.cells[around & (mesh.mesh.cells[:, 4] != 1), 4] = 2 if y == 5 else 1
        return mesh
    return Mutant(at(5), at(3), ("structure", "surface"))


@operator("lines")
def line_vertex_off_its_line(fixture):
    """a line vertex off the line by 1.5 times the bound; harmless: 0.8 times"""
    bound = 0.5 * 1.2 + HALF_A_BOX
    return Mutant(*(with_line_vertex_moved(fixture, (factor * bound, 0, 0), 1.2) for factor in (BEYOND, WITHIN)),
                  ("surface",))


@operator("lines")
def line_vertex_off_instead_of_along(fixture):
    """a line vertex off the line by 0.9 voxels; harmless: along it"""
    return Mutant(with_line_vertex_moved(fixture, (0.9, 0, 0), 1), with_line_vertex_moved(fixture, (0, 0, 0.9), 1),
                  ("surface",))


@operator("lines")
def lines_coarser_than_promised(fixture):
    """lines 0.75 voxels off whose file promises them every 1; harmless: every 2"""
    def off(delta):
        voxels = case(fixture, quadrants(), quadrants(), promising(delta))
        voxels.mesh.vertices[:, 1] += 0.75
        return voxels
    return Mutant(off(1), off(2), ("structure", "surface"))


@operator("lines")
def line_that_is_not_in_the_image(fixture):
    """a line where the image has one label fewer; harmless: where it has all of them"""
    def of(image):
        return case(fixture, image, quadrants(), promising(1))
    return Mutant(of(np.minimum(quadrants(), 3)), of(quadrants()), ("structure", "surface"))


@operator(None, exit_code=2)
def lines_promised_at_no_distance(fixture):
    """a promise of lines at the distance 0; harmless: 1"""
    return Mutant(*(case(fixture, quadrants(), quadrants(), promising(delta)) for delta in (0, 1)))


def around_a_line(degrees, comments=()):
    """Three cells of different labels around an edge, in whose facets these angles are the least."""
    t, turns = math.tan(math.radians(degrees)), np.radians((0, 120, 240))
    ring = np.stack([t * np.cos(turns), t * np.sin(turns), 0 * turns], axis=1)
    return MeditMesh([(0, 0, -1), (0, 0, 1), *ring], [[0, 1, 2, 3, 1], [0, 1, 3, 4, 2], [0, 1, 4, 2, 3]],
                     comments=comments)


def beside(mesh, degrees):
    """Adds a cell of label 1 that shares no vertex with the mesh. One of its facets has this angle."""
    t = math.radians(degrees)
    cell = MeditMesh([(5, 0, 0), (6, 0, 0), (5 + math.cos(t), math.sin(t), 0), (5.6, 0.2, 0.6)], [[0, 1, 2, 3, 1]])
    return joined(mesh, cell)


@operator("boundary_angles")
def angle_near_a_line(_):
    """a facet at a line with an angle 0.3 degrees below 20.7; harmless: 0.3 degrees above"""
    return Mutant(*(Case(around_a_line(LEAST_NEAR_LINES + by), ["--lines-delta", "1"]) for by in (-0.3, 0.3)),
                  ("structure", "surface"))


@operator("boundary_angles")
def angle_near_a_line_by_little(_):
    """a facet at a line with an angle 1e-12 degrees below 20.7; harmless: as much above"""
    return Mutant(*(Case(around_a_line(LEAST_NEAR_LINES + by, promising(1))) for by in (-1e-12, 1e-12)))


@operator("boundary_angles")
def angle_away_from_lines(_):
    """a facet away from lines with an angle of 25 degrees; harmless: 30.3, and 25 near a line"""
    return Mutant(*(Case(beside(around_a_line(25, promising(1)), degrees)) for degrees in (25, 30.3)),
                  ("structure", "surface"))


@operator("boundary_angles")
def angle_near_a_line_without_promise(_):
    """a facet at a line with an angle of 25 degrees in a file that promises no lines; harmless: it promises them"""
    return Mutant(Case(around_a_line(25)), Case(around_a_line(25, promising(1))), ("structure", "surface"))


AXIS = (11 + 2 / 3, 11.5)  # x and y of the line of three labels in the ball: weights 1 - x, x (1 - y), x y are equal


def ball_with_lines(fixture, *options):
    """Returns a mesh of a ball of three labels that keeps their lines, and the options that name its image."""
    z, y, x = np.mgrid[:24, :24, :24] - BALL_CENTER
    sectors = np.where(x < 0, 1, np.where(y < 0, 2, 3))
    image = image_of(fixture, "sectors", np.where(x ** 2 + y ** 2 + z ** 2 < BALL_RADIUS ** 2, sectors, 0))
    return meshed(fixture, image, "--radius", "2", "--lines", *options), image


def edges_by_labels(fixture, mesh):
    """Returns the edges around which the same labels meet, by these labels."""
    labels = {}
    for cell in mesh.cells:
        for edge in itertools.combinations(sorted(cell[:4]), 2):
            labels.setdefault(edge, set()).add(cell[4])
    for *_, facet in fixture.boundary_facets(mesh):
        for edge in itertools.combinations(facet, 2):
            labels[edge].add(0)
    edges = {}
    for edge, around in labels.items():
        edges.setdefault(tuple(sorted(around)), []).append(edge)
    return edges


def with_axis_vertex_moved(fixture, mesh, by):
    """Returns the mesh with a vertex between two edges of the axis moved against the axis x, into label 1."""
    moved = mesh.copy()
    vertices, counts = np.unique(edges_by_labels(fixture, mesh)[1, 2, 3], return_counts=True)
    inner = vertices[counts == 2]
    moved.vertices[inner[abs(mesh.vertices[inner, 2] - BALL_CENTER).argmin()], 0] -= by
    return moved


@operator("surface_vertices")
def line_vertex_off_the_surface(fixture):
    """a vertex of a kept line off all interfaces by 1.5e-5 voxels; harmless: by 0.8e-5"""
    mesh, image = ball_with_lines(fixture)
    bound = VERTEX_BOUND * math.hypot(1, 4 / 9)  # the slope of the interfaces of label 1
    return Mutant(*(Case(with_axis_vertex_moved(fixture, mesh, factor * bound), image) for factor in (BEYOND, WITHIN)),
                  ("structure", "labels", "lines"))


@operator("lines")
def vertex_off_a_kept_line(fixture):
    """a vertex of a kept line off it by 1.5 times the bound; harmless: 0.8 times"""
    mesh, image = ball_with_lines(fixture)
    delta = float(next(line for line in mesh.comments if line.startswith("# promise lines")).split()[-1])
    bound = 0.5 * delta + HALF_A_BOX
    return Mutant(*(Case(with_axis_vertex_moved(fixture, mesh, factor * bound), image) for factor in (BEYOND, WITHIN)))


@operator("lines")
def kept_line_edge_flipped(fixture):
    """the cells of a label around an edge of a kept line relabelled; harmless: around an edge of an interface"""
    mesh, image = ball_with_lines(fixture)
    edges = edges_by_labels(fixture, mesh)
    beyond = np.unique(np.concatenate([edges[labels] for labels in edges if {0, 1} & {*labels}]))

    def cells_of_3_at(edge):
        return (np.isin(mesh.cells[:, :4], edge).sum(axis=1) == 2) & (mesh.cells[:, 4] == 3)

    def vertices_at(edge):
        return np.unique(mesh.cells[cells_of_3_at(edge), :4])

    def flipped(edge):
        flip = mesh.copy()
        flip.cells[cells_of_3_at(edge), 4] = 2
        flip.facets = flip.facets[:0]
        return Case(flip, image)

    on_line = max(edges[1, 2, 3], key=lambda edge: np.hypot(*(mesh.vertices[vertices_at(edge), :2] - AXIS).T).max())
    off_lines = next(edge for edge in edges[2, 3] if not np.isin(vertices_at(edge), beyond).any())
    return Mutant(flipped(on_line), flipped(off_lines), ("structure", "surface"))


@operator("boundary_angles")
def kept_lines_without_promise(fixture):
    """a mesh that keeps its lines in a file that does not promise them; harmless: it does"""
    mesh, image = ball_with_lines(fixture, "--lines-delta", "0.6")
    silent = mesh.copy()
    silent.comments = [line for line in mesh.comments if not line.startswith("# promise lines")]
    return Mutant(Case(silent, image), Case(mesh, image), ("structure", "radius_edge"))
