"""Mutation operators at 1.5 times the tolerance of a claim, each with a harmless neighbour at 0.67 to 0.9 of it.

They follow the operators of mutants.py in one list, OPERATORS. Lengths are voxels unless they say mm: all images here
have unit voxels, and the center of voxel (0, 0, 0) is at the origin.
"""

import math
import subprocess

import numpy as np

from inr_image import write_inr
from medit_mesh import read_medit
from mutants import OPERATORS, REGULAR, Case, Mutant, operator, tetrahedron

__all__ = ["OPERATORS"]

BEYOND, WITHIN = 1.5, 0.8
VERTEX_BOUND = 1e-5  # of surface_vertices
DIAGONAL = math.sqrt(3)
UNCLAIMED = ["# promise unclaimed delaunay\n"]


def image_of(fixture, name, voxels):
    """Returns the options that name an image of voxels[z, y, x]."""
    path = fixture.folder / f"{name}.inr"
    write_inr(path, voxels)
    return ["--image", str(path)]


def meshed(fixture, image, *options):
    path = fixture.folder / "meshed.mesh"
    subprocess.run([fixture.podm, "mesh", image[1], *options, "--quiet", "-o", path], check=True)
    return read_medit(path)


BALL_CENTER, BALL_RADIUS = 11.5, 8.3


def ball(fixture, *options):
    """Returns a mesh of a ball, and the options that name its image."""
    z, y, x = np.mgrid[:24, :24, :24] - BALL_CENTER
    image = image_of(fixture, "ball", x ** 2 + y ** 2 + z ** 2 < BALL_RADIUS ** 2)
    return meshed(fixture, image, "--radius", "2", *options), image


def surface_ids(mesh):
    return np.unique(mesh.facets[:, :3])


def pole_moved(mesh, by):
    """Returns the mesh with the surface vertex nearest to the x axis moved outward along it, its normal there."""
    moved, ids = mesh.copy(), surface_ids(mesh)
    from_axis = np.hypot(*(mesh.vertices[ids, 1:] - BALL_CENTER).T) + 99 * (mesh.vertices[ids, 0] < BALL_CENTER)
    moved.vertices[ids[from_axis.argmin()], 0] += by
    return moved


def surface_moved(mesh, by, share=1.0):
    """Returns the mesh with this share of the surface's vertices, the highest in z, moved away from the ball's center.
    """
    moved, ids = mesh.copy(), surface_ids(mesh)
    ids = ids[mesh.vertices[ids, 2] >= np.quantile(mesh.vertices[ids, 2], 1 - share)]
    outward = mesh.vertices[ids] - BALL_CENTER
    moved.vertices[ids] += by * outward / np.linalg.norm(outward, axis=1)[:, None]
    return moved


def mutant_of(case, bound, still_passes=()):
    """Makes a mutant of case(length) beyond the bound, and a neighbour within it."""
    return Mutant(case(BEYOND * bound), case(WITHIN * bound), still_passes=still_passes)


@operator("surface_vertices")
def vertex_off_the_surface(fixture):
    """a vertex off the surface by 1.5e-5 voxels; harmless: by 0.8e-5"""
    mesh, image = ball(fixture)
    return mutant_of(lambda by: Case(pole_moved(mesh, by), image), VERTEX_BOUND, ("structure", "labels", "fidelity"))


@operator("surface_vertices")
def vertex_off_the_smoothed_surface(fixture):
    """a vertex off a smoothed image's surface by 1.5e-5 voxels; harmless: by 0.8e-5"""
    mesh, image = ball(fixture, "--smooth", "1.5")
    return mutant_of(lambda by: Case(pole_moved(mesh, by), image), VERTEX_BOUND, ("structure", "labels", "fidelity"))


@operator("surface_vertices")
def vertices_on_the_stairs(fixture):
    """the vertices of the voxels' own surface for the smoothed one; harmless: a smoothed mesh"""
    stairs, image = ball(fixture)
    smoothed, _ = ball(fixture, "--smooth", "1.5")
    return Mutant(Case(stairs, [*image, "--smooth", "1.5"]), Case(smoothed, image), still_passes=("structure",))


def halves(fixture):
    """Returns an image of label 1, and of label 2 from x = 12 on."""
    voxels = np.ones((4, 4, 16))
    voxels[:, :, 12:] = 2
    return image_of(fixture, "halves", voxels)


@operator("surface_vertices")
def facet_of_a_far_label(fixture):
    """a facet's label 1.5 times its reach from a vertex on another surface; harmless: 0.8 times"""
    image, delta = halves(fixture), 2.5
    reach = 2 * delta + DIAGONAL

    def at(distance):
        x = 12 - math.sqrt(distance ** 2 - 0.5 ** 2)  # the nearest voxel of label 2 is half a voxel aside
        points = [(x, 1, -0.5), (x + 1, 2, -0.5), (x + 1, 1, 3.5), (x + 1, 3.5, 2)]
        return Case(tetrahedron(points, label=2), [*image, "--delta", str(delta)])
    return mutant_of(at, reach)


def far_centroid(fixture, options, reach):
    """Places a cell of label 2, judged by its centroid, at multiples of `reach` from the voxels of that label."""
    image = halves(fixture)

    def at(distance):
        mesh = tetrahedron(REGULAR * 0.1 + (12 - distance, 1, 2), label=2)
        mesh.comments = UNCLAIMED
        return Case(mesh, [*image, *options], warnings=1)  # no cell has label 1
    return mutant_of(at, reach)


@operator("labels")
def centroid_far_from_its_label(fixture):
    """an optimised mesh's cell 1.5 times two diagonals from its label's voxels; harmless: 0.8 times"""
    return far_centroid(fixture, [], 2 * DIAGONAL)


@operator("labels")
def centroid_further_than_two_delta(fixture):
    """an optimised mesh's cell 1.5 times its reach from its label's voxels, delta being 2.5; harmless: 0.8 times"""
    return far_centroid(fixture, ["--delta", "2.5"], 2 * 2.5 + DIAGONAL)


@operator("labels")
def label_that_the_image_lacks(fixture):
    """a cell with a label that no voxel has; harmless: with a label that one voxel has"""
    voxels = np.ones((6, 6, 6))
    lacking = image_of(fixture, "lacking", voxels)
    voxels[3, 3, 3] = 2
    having = image_of(fixture, "having", voxels)
    cell = tetrahedron(REGULAR * 0.1 + 3, label=2)
    cell.comments = UNCLAIMED
    return Mutant(Case(cell, lacking), Case(cell, having, warnings=1))  # no cell has label 1


@operator("labels")
def label_that_the_mesh_lacks(fixture):
    """no cell of a label of 1500 voxels; harmless: of 800, which is a warning"""
    def lacking(voxels):
        voxels_of_2 = np.arange(4 * 20 * 50).reshape(4, 20, 50) < voxels
        image = image_of(fixture, f"lacks{voxels:.0f}", np.where(voxels_of_2, 2, 1))
        return Case(tetrahedron(REGULAR * 0.1 + (25, 18, 3)), image, warnings=0 if voxels > 1000 else 1)
    return mutant_of(lacking, 1000)


@operator("size")
def radius_over_a_multiple_of_its_place(fixture):
    """a circumradius of 1.5 times the size image times --size-factor; harmless: 0.8 times"""
    path = fixture.folder / "ones.mha"
    path.write_bytes(b"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                     b"TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = -1 -1 -1\nElementSpacing = 2 2 2\n"
                     b"DimSize = 2 2 2\nElementType = MET_DOUBLE\nElementDataFile = LOCAL\n" + np.ones(8).tobytes())

    def over(multiple):
        factor = math.sqrt(3) / multiple  # the regular cell has a circumradius of sqrt(3)
        return Case(tetrahedron(REGULAR), ["--size-image", str(path), "--size-factor", repr(factor)])
    return mutant_of(over, 1)


@operator("fidelity")
def one_vertex_far_off(fixture):
    """a vertex off the image's surface by 1.5 diagonals of a voxel; harmless: by 0.8 diagonals"""
    mesh, image = ball(fixture)
    return mutant_of(lambda by: Case(pole_moved(mesh, by), image), DIAGONAL)


@operator("fidelity")
def one_vertex_further_than_two_delta(fixture):
    """a vertex 1.5 times 2 delta from the image's surface, delta being 2.5; harmless: 0.8 times"""
    mesh, image = ball(fixture)
    return mutant_of(lambda by: Case(pole_moved(mesh, by), [*image, "--delta", "2.5"]), 5)


@operator("fidelity")
def surface_far_off(fixture):
    """the whole surface 1.5 voxels too far out, less than a diagonal; harmless: 0.8 voxels"""
    mesh, image = ball(fixture)
    return mutant_of(lambda by: Case(surface_moved(mesh, by), image), 1)


@operator("fidelity")
def smoothed_surface_far_off(fixture):
    """the whole of a smoothed surface 1.5 voxels too far out; harmless: 0.8 voxels"""
    mesh, image = ball(fixture, "--smooth", "1.5")
    return mutant_of(lambda by: Case(surface_moved(mesh, by), image), 1)


@operator("fidelity")
def share_of_the_surface_far_off(fixture):
    """7.5 % of the surface's vertices too far out by 1.6 voxels; harmless: 4 % of them"""
    mesh, image = ball(fixture)
    return mutant_of(lambda share: Case(surface_moved(mesh, 1.6, share), image), 0.05)


@operator("fidelity")
def share_of_the_image_not_meshed(fixture):
    """a part of the image with 7.4 % of its interface not meshed; harmless: with 3.8 %"""
    def without_a_rod(length):
        voxels = np.zeros((16, 16, 22))
        voxels[3:13, 3:13, 3:13] = 1  # 600 faces
        voxels[4:6, 4:6, 16:16 + length] = 2  # 8 faces per voxel of length, and 8
        image = image_of(fixture, f"rod{length}", voxels)
        mesh = meshed(fixture, image, "--radius", "2", "--labels", "1")
        return Case(mesh, image)
    return Mutant(without_a_rod(5), without_a_rod(2))
