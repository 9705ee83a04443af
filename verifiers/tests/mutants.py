"""Mutation operators: each makes a mesh that one claim must reject, and a harmless neighbour that it must accept.

An operator is a function of a MutantFixture that returns a Mutant. Its docstring is its line in the kill matrix.
"""

import dataclasses
import itertools
import json
import math
import subprocess

import numpy as np

from inr_image import write_inr
from medit_mesh import MeditMesh, kuhn_cubes, read_medit, signed_volumes
from pvtu_mesh import MeshInPieces

OPERATORS = []


def operator(claim, exit_code=1):
    """Registers an operator that `claim` must reject. None: the file itself is refused, with exit code 2."""
    def register(function):
        OPERATORS.append((function, claim, exit_code))
        return function
    return register


@dataclasses.dataclass
class Case:
    """The input of a run of podm-verify."""
    mesh: object  # a MeditMesh, a MeshInPieces, or text
    options: list = dataclasses.field(default_factory=list)
    digits: int = 17
    warnings: int = 0  # number that the claim must report


@dataclasses.dataclass
class Mutant:
    mutant: Case
    neighbour: Case
    still_passes: tuple = ()  # other claims, which must accept the mutant


class MutantFixture:
    """The base mesh (three touching spheres, meshed by podm), its image, and a folder."""

    def __init__(self, podm, folder):
        self.folder = folder
        self.image = folder / "spheres.nii.gz"
        subprocess.run([podm, "phantom", "spheres", "--size", "48", "-o", self.image], check=True, capture_output=True)
        self.podm = podm
        self.base = self.meshed("--radius", "9")
        self.with_image = ["--image", str(self.image)]
        self.random = np.random.default_rng(7)

    def meshed(self, *options):
        path = self.folder / "meshed.mesh"
        subprocess.run([self.podm, "mesh", self.image, *options, "--quiet", "-o", path], check=True)
        return read_medit(path)

    def facet_pairs(self, mesh):
        """Yields (cell, far vertex, cell, far vertex, facet) for every facet with two cells."""
        seen = {}
        for c, cell in enumerate(mesh.cells[:, :4]):
            for k in range(4):
                facet = tuple(sorted(np.delete(cell, k)))
                if facet in seen:
                    yield (*seen[facet], c, cell[k], facet)
                else:
                    seen[facet] = (c, cell[k])

    def edge_rings(self, mesh, length):
        """Yields (cells, vertex, vertex, link in order) for every edge inside a label with `length` cells around it."""
        around = {}
        for c, cell in enumerate(mesh.cells[:, :4]):
            for edge in itertools.combinations(sorted(cell), 2):
                around.setdefault(edge, []).append(c)
        for edge, cells in around.items():
            if len(cells) != length or len(set(mesh.cells[cells, 4])) > 1:
                continue
            sides = [[v for v in mesh.cells[c, :4] if v not in edge] for c in cells]
            ring = sides.pop()
            while side := next((side for side in sides if ring[-1] in side), None):
                sides.remove(side)
                ring.append(sum(side) - ring[-1])
            if not sides and ring.pop() == ring[0]:
                yield cells, *edge, ring

    def boundary_facets(self, mesh):
        pairs = {facet for *_, facet in self.facet_pairs(mesh)}
        for c, cell in enumerate(mesh.cells[:, :4]):
            for k in range(4):
                facet = tuple(sorted(np.delete(cell, k)))
                if facet not in pairs:
                    yield c, cell[k], facet

    def schedule(self, activations):
        """Writes 8 x 6 x 6 unit leaves at the base mesh's low corner, and activations (leaf, begin, end, touched)."""
        low, high = self.base.vertices.min(axis=0), self.base.vertices.max(axis=0)
        scale = 8 / (high[0] - low[0])
        head = {"schema": "podm-schedule/1", "algorithm": "pdr-podm",
                "mesh_to_grid": [scale, 0, 0, -scale * low[0], 0, scale, 0, -scale * low[1], 0, 0, scale,
                                 -scale * low[2]],
                "leaves": [[i, j, k, 1] for i in range(8) for j in range(6) for k in range(6)]}
        lines = [head] + [{"leaf": leaf, "node": 0, "begin_s": begin, "end_s": end, "operations": 1, "deferred": 0,
                           "touched_leaves": touched} for leaf, begin, end, touched in activations]
        path = self.folder / f"schedule{self.random.integers(1 << 30)}.jsonl"
        path.write_text("\n".join(map(json.dumps, lines)))
        return ["--schedule", str(path)]


def tetrahedron(points, label=1):
    mesh = MeditMesh(points, [[0, 1, 2, 3, label]])
    if signed_volumes(mesh)[0] < 0:
        mesh.cells[0, [2, 3]] = mesh.cells[0, [3, 2]]
    return mesh


def joined(a, b):
    cells = b.cells.copy()
    cells[:, :4] += len(a.vertices)
    return MeditMesh(np.vstack([a.vertices, b.vertices]), np.vstack([a.cells, cells]), a.facets, a.comments)


REGULAR = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], dtype=float)


@operator("structure")
def empty_mesh(_):
    """no cells at all"""
    return Mutant(Case(MeditMesh(REGULAR)), Case(tetrahedron(REGULAR)))


@operator("structure")
def not_a_number(fixture):
    """a coordinate that is not a number"""
    mesh = fixture.base.copy()
    mesh.vertices[17, 1] = math.nan
    return Mutant(Case(mesh), Case(fixture.base))


@operator("structure")
def id_out_of_range(fixture):
    """a vertex id one beyond the last"""
    mesh = fixture.base.copy()
    mesh.cells[5, 2] = len(mesh.vertices)
    return Mutant(Case(mesh), Case(fixture.base))


@operator("structure")
def swapped_vertices(fixture):
    """two vertices of a cell swapped; harmless: an even permutation"""
    mesh, even = fixture.base.copy(), fixture.base.copy()
    mesh.cells[11, [0, 1]] = mesh.cells[11, [1, 0]]
    even.cells[11, [0, 1, 2]] = even.cells[11, [1, 2, 0]]
    return Mutant(Case(mesh), Case(even))


@operator("structure")
def left_handed(fixture):
    """every cell reversed; harmless: every cell permuted evenly"""
    mesh, even = fixture.base.copy(), fixture.base.copy()
    mesh.cells[:, [0, 1]] = mesh.cells[:, [1, 0]]
    even.cells[:, [0, 1, 2]] = even.cells[:, [1, 2, 0]]
    return Mutant(Case(mesh), Case(even))


@operator("structure")
def flat_cell(_):
    """four points of a plane; harmless: one of them an ulp above it"""
    flat, above = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 5e-324)]
    return Mutant(Case(tetrahedron(flat)), Case(tetrahedron(above)))


@operator("structure")
def duplicate_cell(fixture):
    """a cell listed twice; harmless: the cells in reverse order"""
    mesh, reverse = fixture.base.copy(), fixture.base.copy()
    mesh.cells = np.vstack([mesh.cells, np.roll(mesh.cells[3, :3], 1).tolist() + mesh.cells[3, 3:].tolist()])
    reverse.cells = reverse.cells[::-1].copy()
    return Mutant(Case(mesh), Case(reverse))


@operator("structure")
def facet_of_three_cells(_):
    """a third cell on a facet; harmless: a cell on a free facet"""
    mesh = MeditMesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1), (1, 1, 2)],
                     [[0, 1, 2, 3, 1], [0, 2, 1, 4, 1]])
    third, free = mesh.copy(), mesh.copy()
    third.cells = np.vstack([third.cells, [0, 1, 2, 5, 1]])
    free.cells = np.vstack([free.cells, [1, 2, 3, 5, 1]])
    return Mutant(Case(third), Case(free))


@operator("structure")
def duplicated_vertices(fixture):
    """a crack: the vertices between two halves doubled; harmless: an unused vertex, which is a warning"""
    orphan = fixture.base.copy()
    orphan.vertices = np.vstack([orphan.vertices, [(999, 999, 999)]])
    return Mutant(Case(cracked(fixture.base)), Case(orphan, warnings=1))


def cracked(base):
    mesh = base.copy()
    upper = mesh.vertices[mesh.cells[:, :4]].mean(axis=1)[:, 2] > 0
    shared = np.intersect1d(mesh.cells[upper, :4], mesh.cells[~upper, :4])
    new_id = {old: len(mesh.vertices) + i for i, old in enumerate(shared)}
    mesh.vertices = np.vstack([mesh.vertices, mesh.vertices[shared]])
    for row in np.flatnonzero(upper):
        mesh.cells[row, :4] = [new_id.get(v, v) for v in mesh.cells[row, :4]]
    return mesh


@operator("structure")
def doubled_point(fixture):
    """a cell with its own point at the place of another vertex; harmless: the same point, used by no cell"""
    unused = fixture.base.copy()
    unused.vertices = np.vstack([unused.vertices, unused.vertices[fixture.base.cells[23, 1]]])
    used = unused.copy()
    used.cells[23, 1] = len(used.vertices) - 1
    return Mutant(Case(used), Case(unused, warnings=1))


@operator("conformity")
def crack(fixture):
    """facets on two sides of a crack that are not one facet; harmless: without the crack"""
    return Mutant(Case(cracked(fixture.base)), Case(fixture.base))


@operator("conformity")
def doubled_along_a_leaf(fixture):
    """a cell's vertex doubled along a leaf boundary; harmless: the same vertex doubled, used by no cell"""
    schedule = fixture.schedule([(0, 0, 1, [0])])
    cubes = kuhn_cubes(2, 1, 1)
    cubes.vertices = cubes.vertices * 16 + fixture.base.vertices.min(axis=0)
    unused = cubes.copy()
    unused.vertices = np.vstack([unused.vertices, unused.vertices[cubes.cells[0, 0]]])
    doubled = unused.copy()
    doubled.cells[0, 0] = len(doubled.vertices) - 1
    return Mutant(Case(doubled, schedule), Case(unused, schedule))


@operator("conformity")
def active_neighbours(fixture):
    """two leaves active at once within two rings; harmless: one after the other, or three apart"""
    def row(i):
        return i * 36
    too_near = fixture.schedule([(row(0), 0, 2, [row(0)]), (row(2), 1, 3, [row(2)])])
    apart = fixture.schedule([(row(0), 0, 2, [row(0)]), (row(2), 2, 3, [row(2)]), (row(5), 2, 4, [row(5)])])
    return Mutant(Case(fixture.base, too_near), Case(fixture.base, apart))


@operator("conformity")
def touched_outside(fixture):
    """an operation that touched a leaf of the second ring; harmless: a leaf of the first ring"""
    return Mutant(Case(fixture.base, fixture.schedule([(0, 0, 1, [0, 72])])),
                  Case(fixture.base, fixture.schedule([(0, 0, 1, [0, 36])])))


@operator("structure")
def overlap_inside(fixture):
    """a positive cell inside another; harmless: the same cell far away"""
    inside, outside = REGULAR * 0.1, REGULAR * 0.1 + 500
    center = fixture.base.vertices[fixture.base.cells[100, :4]].mean(axis=0)
    return Mutant(Case(joined(fixture.base, tetrahedron(inside + center))),
                  Case(joined(fixture.base, tetrahedron(outside))))


@operator("structure")
def interpenetrating_components(_):
    """two cells that cross without a vertex of one in the other; harmless: pulled apart"""
    star = joined(tetrahedron(REGULAR), tetrahedron(-REGULAR))
    apart = joined(tetrahedron(REGULAR), tetrahedron(-REGULAR + 4))
    return Mutant(Case(star), Case(apart))


@operator("structure")
def overlap_at_a_shared_vertex(_):
    """two cells that share a vertex and overlap beside it; harmless: on opposite sides of it"""
    points = [(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2), (3, 1, 1), (1, 3, 1), (1, 1, 3)]
    overlapping = MeditMesh(points, [[0, 1, 2, 3, 1], [0, 4, 5, 6, 1]])
    opposite = MeditMesh([*points[:4], (-3, -1, -1), (-1, -1, -3), (-1, -3, -1)], overlapping.cells)
    return Mutant(Case(overlapping), Case(opposite))


@operator("structure")
def hanging_vertex(_):
    """a vertex in the middle of another cell's free facet; harmless: slightly off it"""
    lower = tetrahedron([(0, 0, 0), (3, 0, 0), (0, 3, 0), (1, 1, -3)])
    upper = np.array([(1, 1, 0), (2, 1, 2), (1, 2, 2), (0.5, 0.5, 2)])
    return Mutant(Case(joined(lower, tetrahedron(upper))), Case(joined(lower, tetrahedron(upper + (0, 0, 1e-15)))))


@operator("structure")
def hanging_on_an_edge(_):
    """a vertex on another cell's edge; harmless: beside it"""
    lower = tetrahedron([(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, -2)])
    upper = np.array([(1, 0, 0), (2, -1, 1), (1, -2, 1), (1, -1, 2)], dtype=float)
    return Mutant(Case(joined(lower, tetrahedron(upper))),
                  Case(joined(lower, tetrahedron(upper - (0, 1e-15, 0)))))


def refilled(mesh, gone, made):
    """Returns `mesh` with the cells `made` in place of `gone`; None unless both fill the same space."""
    label = mesh.cells[gone[0], 4]
    cells = np.array([[*cell, label] for cell in made])
    volumes = signed_volumes(MeditMesh(mesh.vertices, cells))
    before = signed_volumes(MeditMesh(mesh.vertices, mesh.cells[gone])).sum()
    # The made cells have the boundary of the removed ones, so signed volumes add up. Absolute volumes do only if none
    # is inverted.
    if abs(volumes).min() < 1e-6 * before or abs(abs(volumes).sum() - before) > 1e-9 * before:
        return None
    inverted = volumes < 0
    cells[inverted, 2], cells[inverted, 3] = cells[inverted, 3], cells[inverted, 2].copy()
    return MeditMesh(mesh.vertices, np.vstack([np.delete(mesh.cells, gone, axis=0), cells]), mesh.facets, mesh.comments)


def flips_2_3(fixture, mesh):
    """Yields the mesh after each 2-3 flip: a facet inside a label is removed, the edge across it is made."""
    for c, v, d, w, (a, b, e) in fixture.facet_pairs(mesh):
        if mesh.cells[c, 4] == mesh.cells[d, 4]:
            yield refilled(mesh, [c, d], [(a, b, v, w), (b, e, v, w), (e, a, v, w)])


def flips_3_2(fixture, mesh):
    """Yields the inverse: an edge of three cells is removed, the facet across it is made."""
    for gone, a, b, ring in fixture.edge_rings(mesh, 3):
        yield refilled(mesh, gone, [(*ring, a), (*ring, b)])


def flips_4_4(fixture, mesh):
    """Yields the mesh after each 4-4 flip: an edge of four cells is replaced by an edge of two link vertices."""
    for gone, a, b, ring in fixture.edge_rings(mesh, 4):
        for p, x, q, y in (ring, np.roll(ring, 1)):
            yield refilled(mesh, gone, [(p, q, a, x), (p, q, x, b), (p, q, b, y), (p, q, y, a)])


def flip_mutant(fixture, flips, tie):
    """Mutates the base mesh by its first such flip; `tie`, whose vertices are cospherical, stays Delaunay after it."""
    mutant, neighbour = (next(flipped for flipped in flips(fixture, mesh) if flipped is not None)
                         for mesh in (fixture.base, tie))
    return Mutant(Case(mutant), Case(neighbour), still_passes=("structure", "surface"))


POLES = [(0, 0, 5), (0, 0, -5)]
BIPYRAMID = [*POLES, (5, 0, 0), (-3, 4, 0), (-3, -4, 0)]
OCTAHEDRON = [*POLES, (5, 0, 0), (0, 5, 0), (-5, 0, 0), (0, -5, 0)]


@operator("delaunay")
def flip_2_3(fixture):
    """a 2-3 flip; harmless: of five cospherical vertices"""
    two = MeditMesh(BIPYRAMID, [[2, 3, 4, 0, 1], [2, 4, 3, 1, 1]])
    return flip_mutant(fixture, flips_2_3, two)


@operator("delaunay")
def flip_3_2(fixture):
    """a 3-2 flip; harmless: of five cospherical vertices"""
    three = MeditMesh(BIPYRAMID, [[2, 3, 1, 0, 1], [3, 4, 1, 0, 1], [4, 2, 1, 0, 1]])
    return flip_mutant(fixture, flips_3_2, three)


@operator("delaunay")
def flip_4_4(fixture):
    """a 4-4 flip; harmless: of an octahedron, whose vertices are cospherical"""
    four = MeditMesh(OCTAHEDRON, [[2, 3, 1, 0, 1], [3, 4, 1, 0, 1], [4, 5, 1, 0, 1], [5, 2, 1, 0, 1]])
    return flip_mutant(fixture, flips_4_4, four)


@operator("delaunay")
def one_ulp(_):
    """one vertex of eight on a sphere moved in by an ulp; harmless: exactly on it, a tie"""
    cube, moved = kuhn_cubes(1, 1, 1), kuhn_cubes(1, 1, 1)
    moved.vertices[1, 0] = np.nextafter(1.0, 0.0)
    return Mutant(Case(moved), Case(cube))


@operator("delaunay")
def moved_by_epsilon(fixture):
    """every vertex moved at random by about 0.3 mm; harmless: by about 1e-9 mm"""
    far, near = fixture.base.copy(), fixture.base.copy()
    steps = fixture.random.normal(size=fixture.base.vertices.shape)
    far.vertices += 0.3 * steps
    near.vertices += 1e-9 * steps
    return Mutant(Case(far), Case(near))


@operator("delaunay")
def foreign_vertex_in_a_ball(_):
    """a vertex of another component in a circumball, in no cell; harmless: outside the ball"""
    deep, clear = REGULAR * 0.05 + (1.2, 1.2, 0), REGULAR * 0.05 + (2, 2, 0)
    return Mutant(Case(joined(tetrahedron(REGULAR), tetrahedron(deep))),
                  Case(joined(tetrahedron(REGULAR), tetrahedron(clear))))


@operator("delaunay")
def rounded_digits(fixture):
    """coordinates rounded to 3 digits; harmless: to 15"""
    return Mutant(Case(fixture.base, digits=3), Case(fixture.base, digits=15))


@operator("delaunay")
def rounded_to_six_digits(_):
    """a far vertex just outside a ball, which 6 digits move into it; harmless: 9 digits"""
    z = 10.000006
    points = [(1, 0, z), (-0.6, 0.8, z), (-0.6, -0.8, z), (0, 0, z + 1), (0, 0, z - 1 - 5e-7)]
    mesh = MeditMesh(points, [[0, 1, 2, 3, 1], [0, 2, 1, 4, 1]])
    return Mutant(Case(mesh, digits=6), Case(mesh, digits=9))


def needle(height):
    s = math.sqrt(3) / 3
    return tetrahedron([(s, 0, 0), (-s / 2, 0.5, 0), (-s / 2, -0.5, 0), (0, 0, height)])


@operator("radius_edge")
def needle_over_the_bound(_):
    """a needle of ratio 1.93 (1 + 1e-12); harmless: 1.93 (1 - 1e-12)"""
    height = (3.86 + math.sqrt(3.86 ** 2 - 4 / 3)) / 2  # R = (h^2 + 1/3) / 2h above a triangle of side 1
    return Mutant(Case(needle(height * (1 + 1e-12))), Case(needle(height * (1 - 1e-12))))


@operator("radius_edge")
def flat_cell_without_a_ball(_):
    """a flat cell, whose ratio is infinite; harmless: a regular one"""
    return Mutant(Case(tetrahedron([(0, 0, 0), (1, 0, 0), (0, 1, 0), (3, 1, 0)])), Case(tetrahedron(REGULAR)))


def over_triangle(a, b, c):
    """Returns a cell over a triangle; its other facets have no angle below 31 degrees."""
    a, b, c = (np.array(p, dtype=float) for p in (a, b, c))
    normal = np.cross(b - a, c - a)
    for seed in range(2000):
        x, y, z = np.random.default_rng(seed).uniform((-0.5, -0.5, 0.2), (1.5, 1.5, 1.2))
        apex = a + x * (b - a) + y * (c - a) + z * normal / math.sqrt(np.linalg.norm(normal))
        if min(least_angle(*facet, apex) for facet in ((a, b), (b, c), (c, a))) > 31:
            return tetrahedron([a, b, c, apex])
    raise RuntimeError("no apex found")


def least_angle(a, b, c):
    sides = sorted(np.linalg.norm(p - q) for p, q in ((a, b), (b, c), (c, a)))
    cosine = (sides[1] ** 2 + sides[2] ** 2 - sides[0] ** 2) / (2 * sides[1] * sides[2])
    return math.degrees(math.acos(cosine))


def isosceles(degrees):
    t = math.radians(degrees)
    return (0, 0, 0), (2 * math.cos(t), 0, 0), (math.cos(t), math.sin(t), 0)


@operator("boundary_angles")
def angle_under_30(_):
    """a boundary angle of 29.999 degrees; harmless: 30.001"""
    return Mutant(Case(over_triangle(*isosceles(29.999))), Case(over_triangle(*isosceles(30.001))))


@operator("boundary_angles")
def angle_of_30(_):
    """a boundary angle of exactly 30 degrees, in integers; harmless: an ulp more"""
    exact = over_triangle((0, 0, 0), (1, 1, 0), (2, 1, 1))  # cos^2 = 9 / 12
    more = exact.copy()
    more.vertices[1, 1] = np.nextafter(1.0, 2.0)  # the apex, away from the base between the two such angles
    return Mutant(Case(exact), Case(more))


def wedge(degrees):
    """Returns a cell with two facets that meet at this angle; its other angles are moderate."""
    t = math.radians(degrees)
    return tetrahedron([(-0.5, 0, 0), (0.5, 0, 0), (0, 1, 0), (0, math.cos(t), math.sin(t))])


DIHEDRAL = ["--min-dihedral", "8", "--max-dihedral", "165"]


@operator("dihedral")
def dihedral_under_the_bound(_):
    """a dihedral angle of 7.99 degrees; harmless: 8.01"""
    return Mutant(Case(wedge(7.99), DIHEDRAL), Case(wedge(8.01), DIHEDRAL))


@operator("dihedral")
def dihedral_over_the_bound(_):
    """a dihedral angle of 165.01 degrees; harmless: 164.99"""
    largest = ["--max-dihedral", "165"]
    return Mutant(Case(wedge(165.01), largest), Case(wedge(164.99), largest))


@operator("dihedral")
def broken_promise(_):
    """an angle of 7.99 degrees in a file that promises 8; harmless: in one that promises 7"""
    def promising(least):
        mesh = wedge(7.99)
        mesh.comments = [f"# promise dihedral {least} 175\n"]
        return Case(mesh)
    return Mutant(promising(8), promising(7))


@operator(None, exit_code=2)
def unknown_promise(_):
    """a promise that no program knows; harmless: a known one"""
    def promising(words):
        mesh = tetrahedron(REGULAR)
        mesh.comments = [f"# promise {words}\n"]
        return Case(mesh)
    return Mutant(promising("dihedral of eight"), promising("unclaimed delaunay"))


def hinge(shift):
    """Returns a flat cell, with neighbours, with two facets on an interface; a peel gives it to the other label."""
    points = [(-1, 0, 0), (1, 0, 0), (0, -shift, 0.02), (0, shift, 0.02), (0, 0, -1.5), (0, 0, 1.5)]
    u, w, r, s, below, above = range(6)
    cells = [[u, w, r, s, 1], [u, w, s, below, 2], [w, u, r, below, 2], [r, s, u, above, 1], [s, r, w, above, 1]]
    mesh = MeditMesh(points, cells)
    turned = signed_volumes(mesh) < 0
    mesh.cells[turned, 2], mesh.cells[turned, 3] = mesh.cells[turned, 3], mesh.cells[turned, 2].copy()
    return mesh


@operator("boundary_angles")
def peel_to_29_9_degrees(_):
    """a peel whose new facets have an angle of 29.9 degrees; harmless: of 30.1"""
    def peeled(degrees):
        mesh = hinge(1 / math.tan(math.radians(degrees)))  # half the new edge over half the old one
        mesh.cells[0, 4] = 2
        return mesh
    return Mutant(Case(peeled(29.9)), Case(peeled(30.1)), still_passes=("structure",))


@operator("surface")
def peel_with_stale_facets(fixture):
    """a cell given to the label across an interface, with the old list of facets; harmless: without a list"""
    mesh = fixture.base.copy()
    c, d = next((c, d) for c, _, d, _, _ in fixture.facet_pairs(mesh) if mesh.cells[c, 4] != mesh.cells[d, 4])
    mesh.cells[c, 4] = mesh.cells[d, 4]
    unlisted = mesh.copy()
    unlisted.facets = unlisted.facets[:0]
    return Mutant(Case(mesh), Case(unlisted), still_passes=("structure",))


@operator("size")
def radius_over_the_bound(_):
    """a circumradius of sqrt(3) under a bound an ulp below it; harmless: an ulp above"""
    root = math.sqrt(3)  # rounded down: its square is below 3
    return Mutant(Case(tetrahedron(REGULAR), ["--radius", repr(root)]),
                  Case(tetrahedron(REGULAR), ["--radius", repr(float(np.nextafter(root, 2)))]))


@operator("size")
def radius_over_its_label(_):
    """a cell over its own label's bound alone; harmless: the bound is another label's"""
    return Mutant(Case(tetrahedron(REGULAR), ["--radius", "9", "--radius-of", "1=1.7"]),
                  Case(tetrahedron(REGULAR), ["--radius", "9", "--radius-of", "2=1.7"]))


@operator("size")
def radius_over_its_place(fixture):
    """a cell over the size image's mean at its circumcenter by a thousandth; harmless: under it"""
    def by_place(name, last):
        voxels = np.ones((2, 2, 2))
        voxels[1] = last
        path = fixture.folder / name
        path.write_bytes(b"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                         b"TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = -1 -1 -1\nElementSpacing = 2 2 2\n"
                         b"DimSize = 2 2 2\nElementType = MET_DOUBLE\nElementDataFile = LOCAL\n" + voxels.tobytes())
        return ["--size-image", str(path)]
    middle = 2 * math.sqrt(3) - 1  # makes the mean sqrt(3), the bound at the center of the regular cell
    return Mutant(Case(tetrahedron(REGULAR), by_place("over.mha", middle - 0.001)),
                  Case(tetrahedron(REGULAR), by_place("under.mha", middle + 0.001)))


def voxel_halves(fixture):
    """Returns an image of unit voxels: label 1 at the regular cell's circumcenter, label 2 from 1.5 mm beside it on."""
    voxels = np.ones((4, 4, 8))
    voxels[:, :, 4:] = 2
    path = fixture.folder / "halves.inr"
    write_inr(path, voxels, offset=-2)
    return ["--image", str(path)]


@operator("size")
def radius_over_the_bound_near(fixture):
    """a cell over its bound at exactly the width from an interface; harmless: a width less by an ulp"""
    def near(width):
        return Case(tetrahedron(REGULAR), [*voxel_halves(fixture), "--size-near", f"1,2=1.7:{width!r}"])
    return Mutant(near(1.5), near(float(np.nextafter(1.5, 0))))


@operator("size")
def radius_over_its_grade(fixture):
    """a cell over a bound that grows from 2 mm away, and over the slack, by a thousandth; harmless: under it"""
    def growing(radius):
        return Case(tetrahedron(REGULAR), [*voxel_halves(fixture), "--radius-of", f"2={radius!r}", "--grade", "0.25"])
    bound = math.sqrt(3) - 0.25 * (2 + math.sqrt(3) / 2)
    return Mutant(growing(bound - 0.001), growing(bound + 0.001))


@operator(None, exit_code=2)
def near_a_label_that_is_not_there(fixture):
    """a bound near a label that the image does not have; harmless: near a label that it has"""
    def near(label):
        return Case(tetrahedron(REGULAR), [*voxel_halves(fixture), "--size-near", f"1,{label}=9"])
    return Mutant(near(3), near(2))


@operator("labels")
def swapped_labels(fixture):
    """two labels swapped; harmless: not swapped"""
    mesh = fixture.base.copy()
    mesh.cells[:, 4] = np.select([mesh.cells[:, 4] == 1, mesh.cells[:, 4] == 2], [2, 1], mesh.cells[:, 4])
    return Mutant(Case(mesh, fixture.with_image), Case(fixture.base, fixture.with_image))


@operator("labels")
def one_wrong_label(fixture):
    """one cell with another label; harmless: with its own"""
    mesh = fixture.base.copy()
    mesh.cells[50, 4] = 3 if mesh.cells[50, 4] != 3 else 1
    return Mutant(Case(mesh, fixture.with_image), Case(fixture.base, fixture.with_image))


@operator("labels")
def half_voxel_shift(fixture):
    """all vertices shifted by half a voxel; harmless: by 1e-9 mm"""
    far, near = fixture.base.copy(), fixture.base.copy()
    far.vertices += 0.5 * 180 / 41
    near.vertices += 1e-9
    return Mutant(Case(far, fixture.with_image), Case(near, fixture.with_image))


@operator("labels")
def called_smoothed(fixture):
    """a mesh of the image's voxels whose file states smoothing; harmless: it states none"""
    mesh = fixture.base.copy()
    mesh.comments = [*mesh.comments, "# promise smoothed 6.5\n"]
    return Mutant(Case(mesh, fixture.with_image), Case(fixture.base, fixture.with_image))


@operator(None, exit_code=2)
def smoothed_by_nothing(_):
    """a file that states smoothing by 0 mm; harmless: by 1.5"""
    def smoothed(width):
        mesh = tetrahedron(REGULAR)
        mesh.comments = [f"# promise smoothed {width}\n"]
        return Case(mesh)
    return Mutant(smoothed("0"), smoothed("1.5"))


@operator("labels")
def mirrored_axis(fixture):
    """x mirrored, cells reversed to stay positive; harmless: coordinates in LPS, with --space LPS"""
    mirrored, lps = fixture.base.copy(), fixture.base.copy()
    mirrored.vertices[:, 0] *= -1
    mirrored.cells[:, [0, 1]] = mirrored.cells[:, [1, 0]]
    lps.vertices[:, :2] *= -1
    return Mutant(Case(mirrored, fixture.with_image), Case(lps, [*fixture.with_image, "--space", "LPS"]))


@operator("labels")
def dropped_component(fixture):
    """all cells of a label dropped; harmless: none dropped"""
    mesh = fixture.base.copy()
    mesh.cells = mesh.cells[mesh.cells[:, 4] != 1]
    mesh.facets = mesh.facets[:0]
    return Mutant(Case(mesh, fixture.with_image), Case(fixture.base, fixture.with_image))


@operator("surface")
def dropped_cell(fixture):
    """an inner cell dropped, its hole not among the listed facets; harmless: no facets listed, no cell dropped"""
    mesh = fixture.base.copy()
    boundary = {c for c, *_ in fixture.boundary_facets(mesh)}
    inner = next(c for c in range(len(mesh.cells)) if c not in boundary)
    mesh.cells = np.delete(mesh.cells, inner, axis=0)
    unlisted = fixture.base.copy()
    unlisted.facets = unlisted.facets[:0]
    return Mutant(Case(mesh), Case(unlisted))


@operator("surface")
def dropped_facet(fixture):
    """a boundary facet not listed; harmless: listed last"""
    mesh, last = fixture.base.copy(), fixture.base.copy()
    mesh.facets = mesh.facets[1:]
    last.facets = np.roll(last.facets, -1, axis=0)
    return Mutant(Case(mesh), Case(last))


@operator("surface")
def stale_facet_tag(fixture):
    """a facet listed with another pair of labels; harmless: with its own"""
    mesh = fixture.base.copy()
    mesh.facets[0, 3] = 2 if mesh.facets[0, 3] != 2 else 1
    return Mutant(Case(mesh), Case(fixture.base))


@operator("fidelity")
def shrunk(fixture):
    """a mesh shrunk by a fifth; harmless: by 1e-6"""
    far, near = fixture.base.copy(), fixture.base.copy()
    far.vertices *= 0.8
    near.vertices *= 1 - 1e-6
    return Mutant(Case(far, fixture.with_image), Case(near, fixture.with_image))


@operator("fidelity")
def sampled_coarsely(fixture):
    """a mesh whose surfaces are sampled every six voxels; harmless: the same with --delta"""
    coarse = fixture.meshed("--radius", "90", "--delta", "25")
    return Mutant(Case(coarse, fixture.with_image), Case(coarse, [*fixture.with_image, "--delta", "25"]))


@operator(None, exit_code=2)
def truncated_file(fixture):
    """the file cut off in its cells; harmless: the whole file"""
    path = fixture.folder / "whole.mesh"
    fixture.base.write(path)
    text = path.read_text()
    return Mutant(Case(text[:2 * len(text) // 3]), Case(fixture.base))


@operator("structure")
def cell_in_two_pieces(fixture):
    """a cell in two of three pieces of a mesh; harmless: in one"""
    mesh, apart = MeshInPieces(fixture.base, 3), MeshInPieces(fixture.base, 3)
    first, second = mesh.pieces[:2]
    known = set(second.ids)
    cell = next(cell for cell in first.cells if sum(first.ids[v] in known for v in cell[:4]) >= 3)
    for vertex in cell[:4]:
        if first.ids[vertex] not in known:
            second.ids = np.append(second.ids, first.ids[vertex])
            second.points = np.append(second.points, first.points[vertex:vertex + 1], axis=0)
    twin = [np.flatnonzero(second.ids == first.ids[vertex])[0] for vertex in cell[:4]]
    second.cells = np.append(second.cells, [[*twin, cell[4]]], axis=0)
    return Mutant(Case(mesh), Case(apart))


@operator("surface")
def cell_missing_between_pieces(fixture):
    """a cell at the border of two pieces in neither; harmless: in one, whose cells are reordered"""
    mesh, moved = MeshInPieces(fixture.base, 3), MeshInPieces(fixture.base, 3)
    first, shared = mesh.pieces[0], set(mesh.pieces[1].ids)
    border = [c for c, cell in enumerate(first.cells) if sum(first.ids[v] in shared for v in cell[:4]) == 3]
    mesh.pieces[0].cells = np.delete(first.cells, border[0], axis=0)
    moved.pieces[0].cells = np.roll(moved.pieces[0].cells, 1, axis=0)
    return Mutant(Case(mesh), Case(moved))


@operator("conformity")
def border_cut_otherwise(fixture):
    """two points for one vertex on either side of a border; harmless: one point, with the greatest number"""
    mesh, renumbered = MeshInPieces(fixture.base, 2), MeshInPieces(fixture.base, 2)
    shared, greatest = mesh.shared_id(), max(piece.ids.max() for piece in mesh.pieces)
    second = mesh.pieces[1]
    second.ids[second.ids == shared] = greatest + 1
    for piece in renumbered.pieces:
        here = [piece.ids == shared, piece.ids == greatest]
        piece.ids = np.select(here, [greatest, shared], piece.ids)
    return Mutant(Case(mesh), Case(renumbered))


@operator(None, exit_code=2)
def vertex_moved_in_one_piece(fixture):
    """a shared vertex moved by an ulp in one piece; harmless: in both pieces"""
    mesh, both = MeshInPieces(fixture.base, 2), MeshInPieces(fixture.base, 2)
    shared = mesh.shared_id()
    for piece in [mesh.pieces[1], *both.pieces]:
        piece.points[piece.ids == shared] = np.nextafter(piece.points[piece.ids == shared], np.inf)
    return Mutant(Case(mesh), Case(both))
