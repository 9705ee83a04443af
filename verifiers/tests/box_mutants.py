"""Mutation operators of the claim box: a block of voxels that fills its image, each voxel cut into six cells.

The center of voxel (0, 0, 0) is at (0.5, 0.5, 0.5): the sides of the box have whole coordinates. Voxels are [z, y, x].
"""

import numpy as np

from inr_image import write_inr
from line_mutants import OPERATORS, promising, quadrants
from mutants import Case, Mutant, operator
from topology_mutants import mesh_of

__all__ = ["OPERATORS"]

SIZE = np.array([6, 5, 4])  # voxels along x, y and z


def block():
    voxels = np.ones(SIZE[::-1], dtype=int)
    voxels[:, :, 3:] = 2
    return voxels


def case(fixture, change=None, voxels=None, image=None):
    """Returns a case with the mesh of `voxels`, whose vertices change(vertices) moves."""
    path = fixture.folder / f"box{fixture.random.integers(1 << 30)}.inr"
    write_inr(path, block() if image is None else image, offset=0.5)
    mesh = mesh_of(block() if voxels is None else voxels)
    if change:
        change(mesh.vertices)
    return Case(mesh, ["--image", str(path), "--box", "flat"])


def moved(at, by):
    """Returns a change of the vertex at `at`."""
    def change(vertices):
        (found,) = np.flatnonzero((vertices == at).all(axis=1))
        vertices[found] += by
    return change


def next_double(vertices, which):
    vertices[which, 0] = np.nextafter(vertices[which, 0], np.inf)


@operator("box")
def vertex_off_its_side(fixture):
    """a vertex 1e-9 mm off its side; harmless: moved along the side"""
    return Mutant(case(fixture, moved((6, 2, 2), (-1e-9, 0, 0))), case(fixture, moved((6, 2, 2), (0, 1e-9, 0.1))),
                  ("structure",))


@operator("box")
def vertex_off_its_side_by_a_double(fixture):
    """a vertex at the next double; harmless: all vertices of the side are there"""
    def one(vertices):
        next_double(vertices, (vertices == (6, 2, 2)).all(axis=1))

    def side(vertices):
        next_double(vertices, vertices[:, 0] == 6)
    return Mutant(case(fixture, one), case(fixture, side), ("structure",))


@operator("box")
def side_two_doubles_off(fixture):
    """all vertices of a side two doubles off; harmless: one double off"""
    def once(vertices):
        next_double(vertices, vertices[:, 0] == 6)

    def twice(vertices):
        on_side = vertices[:, 0] == 6
        next_double(vertices, on_side)
        next_double(vertices, on_side)
    return Mutant(case(fixture, twice), case(fixture, once), ("structure",))


@operator("box")
def facet_dented(fixture):
    """a dent in a side; harmless: a vertex inside that is moved as far"""
    return Mutant(case(fixture, moved((6, 2, 2), (-0.2, 0, 0))), case(fixture, moved((5, 2, 2), (-0.2, 0, 0))),
                  ("structure",))


@operator("box")
def facet_bulging(fixture):
    """a bump on a side; harmless: a vertex inside that is moved as far"""
    return Mutant(case(fixture, moved((2, 2, 0), (0, 0, -0.2))), case(fixture, moved((2, 2, 1), (0, 0, -0.2))),
                  ("structure",))


@operator("box")
def side_missing(fixture):
    """a side without its outermost voxels; harmless: the image has none there"""
    voxels = block()
    voxels[:, :, 5] = 0
    return Mutant(case(fixture, voxels=voxels), case(fixture, voxels=voxels[:, :, :5], image=voxels[:, :, :5]),
                  ("structure",))


@operator("box")
def edge_blunt(fixture):
    """vertices of an edge of the box that are inside; harmless: moved along the edge"""
    def change(by):
        def move(vertices):
            for z in (1, 2, 3):
                moved((6, 5, z), by)(vertices)
        return move
    return Mutant(case(fixture, change((-0.1, -0.1, 0))), case(fixture, change((0, 0, 0.1))), ("structure",))


@operator("box")
def corner_blunt(fixture):
    """a corner of the box that is inside; harmless: the vertex before it on the edge is moved as far"""
    return Mutant(case(fixture, moved((6, 5, 4), (-0.3, -0.3, -0.3))), case(fixture, moved((6, 5, 3), (0, 0, -0.3))),
                  ("structure",))


@operator("lines")
def line_in_a_side_moved(fixture):
    """a vertex of a line in a side of the box moved across the line, in the plane; harmless: along it"""
    def lines(by):
        mutant = case(fixture, moved((6, 2, 0), by), quadrants(), quadrants())
        mutant.mesh.comments = promising(1)
        return mutant
    return Mutant(lines((0.9, 0, 0)), lines((0, 0.9, 0)), ("surface",))


@operator("lines")
def line_in_a_side_missing(fixture):
    """a block of two labels of which the mesh has one; harmless: it has both"""
    def lines(voxels):
        mutant = case(fixture, None, voxels, block())
        mutant.mesh.comments = promising(1)
        return mutant
    return Mutant(lines(np.ones_like(block())), lines(block()), ("structure", "surface", "box"))
