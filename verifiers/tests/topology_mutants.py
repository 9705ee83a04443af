"""Mutation operators of the claim topology: meshes of voxels cut into six cells each, some of whose voxels differ.

The center of voxel (0, 0, 0) is at (0.5, 0.5, 0.5), so that vertices have whole coordinates. Voxels are [z, y, x].
"""

import itertools

import numpy as np

from inr_image import write_inr
from medit_mesh import MeditMesh, kuhn_cubes
from mutants import Case, Mutant, operator
from tolerance_mutants import OPERATORS

__all__ = ["OPERATORS"]


def mesh_of(voxels, comments=()):
    """Returns six cells for each voxel that is not 0, with the voxel's label."""
    nz, ny, nx = voxels.shape
    mesh = kuhn_cubes(nx, ny, nz)
    labels = np.repeat(voxels.ravel(), 6)
    mesh.cells[:, 4] = labels
    cells = mesh.cells[labels != 0]
    used = np.unique(cells[:, :4])
    number = np.zeros(len(mesh.vertices), dtype=int)
    number[used] = np.arange(len(used))
    cells[:, :4] = number[cells[:, :4]]
    return MeditMesh(mesh.vertices[used], cells, comments=comments)


def case(fixture, image, voxels, comments=(), warnings=0):
    path = fixture.folder / f"topology{fixture.random.integers(1 << 30)}.inr"
    write_inr(path, image, offset=0.5)
    return Case(mesh_of(voxels, comments), ["--image", str(path)], warnings=warnings)


def changed(voxels, changes):
    """Returns a copy in which voxels (x, y, z) have other labels."""
    copy = voxels.copy()
    for (x, y, z), label in changes.items():
        copy[z, y, x] = label
    return copy


def pair(fixture, image, mutant, neighbour):
    return Mutant(case(fixture, image, changed(image, mutant)), case(fixture, image, changed(image, neighbour)),
                  ("structure",))


def two_blocks(length=3):
    """Two blocks of 3^3 voxels with a bridge of one voxel's width between them."""
    voxels = np.zeros((5, 5, 8 + length), dtype=int)
    voxels[1:4, 1:4, 1:4] = 1
    voxels[1:4, 1:4, 4 + length:7 + length] = 1
    voxels[2, 2, 4:4 + length] = 1
    return voxels


def plate(width=7):
    """A plate of one voxel's thickness with two holes."""
    voxels = np.zeros((3, 7, width + 2), dtype=int)
    voxels[1, 1:6, 1:width + 1] = 1
    voxels[1, 3, 3] = voxels[1, 3, 5] = 0
    return voxels


@operator("topology")
def bridge_cut(fixture):
    """a bridge between two blocks that is cut; harmless: a corner of a block that is missing"""
    return pair(fixture, two_blocks(), {(5, 2, 2): 0}, {(1, 1, 1): 0})


@operator("topology")
def bridge_of_another_label_cut(fixture):
    """a bridge whose middle has another label; harmless: a block's corner that has it, where the image has it, too"""
    image = changed(two_blocks(), {(1, 1, 1): 2})
    return pair(fixture, image, {(5, 2, 2): 2}, {(2, 1, 1): 2})


@operator("topology")
def hole_closed(fixture):
    """a hole of a plate that is closed; harmless: a bump beside it"""
    return pair(fixture, plate(), {(3, 3, 1): 1}, {(4, 3, 2): 1})


@operator("topology")
def hole_made(fixture):
    """a plate with a third hole; harmless: one that is open to its side"""
    return pair(fixture, changed(plate(), {(3, 3, 1): 1}), {(3, 3, 1): 0}, {(1, 3, 1): 0})


@operator("topology")
def components_joined(fixture):
    """two components that a voxel joins; harmless: one that grows by a voxel"""
    image = changed(two_blocks(), {(4, 2, 2): 0, (5, 2, 2): 0, (6, 2, 2): 0})
    return pair(fixture, image, {(4, 2, 2): 1, (5, 2, 2): 1, (6, 2, 2): 1}, {(4, 2, 2): 1})


@operator("topology")
def component_dropped(fixture):
    """a component that is missing; harmless: a voxel of it that is missing"""
    image = changed(two_blocks(), {(4, 2, 2): 0, (5, 2, 2): 0, (6, 2, 2): 0})
    block = {at: 0 for at in itertools.product(range(1, 4), repeat=3)}
    return pair(fixture, image, block, {(1, 1, 1): 0})


@operator("topology")
def component_added(fixture):
    """a voxel's component that the image has not; harmless: where the image has it"""
    block = two_blocks()
    added = changed(np.pad(block, ((0, 2), (0, 0), (0, 0))), {(2, 2, 6): 1})
    without = changed(added, {(2, 2, 6): 0})
    return Mutant(case(fixture, without, added), case(fixture, added, added), ("structure",))


@operator("topology")
def cavity_filled(fixture):
    """a shell whose cavity is filled; harmless: a shell without a corner"""
    image = np.zeros((7, 7, 7), dtype=int)
    image[1:6, 1:6, 1:6] = 1
    image[3, 3, 3] = 0
    return pair(fixture, image, {(3, 3, 3): 1}, {(1, 1, 1): 0})


@operator("topology")
def cavity_opened(fixture):
    """a shell with a hole; harmless: one with a dent"""
    image = np.zeros((7, 7, 7), dtype=int)
    image[1:6, 1:6, 1:6] = 1
    image[3, 3, 3] = 0
    return pair(fixture, image, {(3, 3, 2): 0, (3, 3, 1): 0}, {(3, 3, 1): 0})


@operator("topology")
def one_of_two_at_an_edge_dropped(fixture):
    """one of two voxels that share an edge is missing; harmless: both are there, an ambiguous place"""
    image = np.zeros((4, 4, 4), dtype=int)
    image[1, 1, 1] = image[1, 2, 2] = 1
    return pair(fixture, image, {(2, 2, 1): 0}, {})


@operator("topology")
def more_than_ambiguous_places_explain(fixture):
    """a hole closed beside an ambiguous place that another difference uses up; harmless: only that difference"""
    image = changed(plate(10), {(10, 1, 1): 0, (9, 2, 1): 0})
    return pair(fixture, image, {(3, 3, 1): 1}, {})


@operator("topology")
def large_piece_at_an_ambiguous_place(fixture):
    """a component split into large pieces at an ambiguous place; harmless: a voxel that is split off there"""
    image = np.zeros((6, 7, 12), dtype=int)
    image[1:4, 1:6, 1:11] = 1
    image[4, 1, 1] = image[4, 2, 2] = 1
    wall = {(6, y, z): 0 for y in range(1, 6) for z in range(1, 4)}
    below = {(x, y, 3): 0 for x in (1,) for y in (1,)}
    return pair(fixture, image, wall, below)


@operator("topology")
def listed_with_another_kind(fixture):
    """a bridge cut that the file lists as a lost component; harmless: it lists the split"""
    image = two_blocks()
    cut = changed(image, {(5, 2, 2): 0})

    def listing(kind):
        comments = ["# promise topology 1\n", f"# promise differs {kind} 1 5 2 2\n"]
        return case(fixture, image, cut, comments, warnings=1)
    return Mutant(listing("lost"), listing("split"), ("structure",))


@operator("topology")
def listed_once_but_twice_there(fixture):
    """two holes closed in two plates, of which the file lists one; harmless: it lists both"""
    image = np.concatenate([plate(), plate()])
    closed = changed(image, {(3, 3, 1): 1, (3, 3, 4): 1})

    def listing(planes):
        comments = [f"# promise topology {len(planes)}\n",
                    *(f"# promise differs handles 1 3 3 {z}\n" for z in planes)]
        return case(fixture, image, closed, comments, warnings=len(planes))
    return Mutant(listing([1]), listing([1, 4]), ("structure",))


@operator(None, exit_code=2)
def topology_promise_without_a_number(fixture):
    """a promise of the topology that lists no number; harmless: it does"""
    def promising(words):
        return case(fixture, plate(), plate(), [f"# promise {words}\n"])
    return Mutant(promising("topology some"), promising("topology 0"))
