"""The operation log as the pictures of the documentation read it, and the regions that they draw."""
import itertools
import json
import struct
import tempfile
import unittest
from pathlib import Path

import numpy
import paths  # noqa: F401  (makes concepts importable)
from concepts.operation_log import CIRCUMCENTER, ISOSURFACE, MOVED, LogError, read_log
from concepts.pictures import conflict, operations, refinement
from concepts.triangulation import Labels, Plane, Triangulation
from scipy.spatial import Delaunay

BOX = [-1.0, -1, -1, 1, 1, 1]


def log_bytes(entries):
    """`entries`: (sequence, point, vertex, worker, kind, removed vertices)."""
    body = struct.pack("<II", len(entries), sum(len(entry[5]) for entry in entries))
    for sequence, point, vertex, worker, kind, removed in entries:
        body += struct.pack("<Q3d4I", sequence, *point, vertex, worker, kind, len(removed))
    body += b"".join(struct.pack("<I", one) for entry in entries for one in entry[5])
    return b"podmlog1" + body + struct.pack("<II", 0, 0) + json.dumps({"box": BOX}).encode()


def random_log(count, seed=3):
    generator = numpy.random.default_rng(seed)
    entries = []
    for number in range(count):
        kind, removed = (ISOSURFACE, CIRCUMCENTER)[number % 2], []
        if kind == ISOSURFACE and number == count - 2:
            removed = [count - 3]  # a circumcenter
        entries.append((number, generator.uniform(-0.9, 0.9, 3), number, number % 3, kind, removed))
    return log_bytes(entries)


class ReadLog(unittest.TestCase):
    def read(self, data):
        with tempfile.TemporaryDirectory() as name:
            path = Path(name) / "run.log"
            path.write_bytes(data)
            return read_log(path)

    def test_operations_come_by_sequence_and_vertices_come_and_go(self):
        log = self.read(log_bytes([(5, (0.5, 0, 0), 1, 0, ISOSURFACE, [0]), (2, (0, 0, 0), 0, 1, CIRCUMCENTER, []),
                                   (9, (0, 0, 0), 7, 0, MOVED, [1])]))
        self.assertEqual(log.operations["sequence"].tolist(), [2, 5, 9])
        self.assertEqual([sorted(one for one in log.vertices_before(at) if one >= 0) for at in range(4)],
                         [[], [0], [1], [7]])
        self.assertEqual(len(log.vertices_before(0)), 8)
        self.assertEqual(log.vertices_before(3)[7].tolist(), [0.5, 0, 0])

    def test_what_is_no_log_is_refused(self):
        for data in (b"", b"podmlog2", random_log(9)[:200], random_log(9)[:-5]):
            with self.subTest(size=len(data)), self.assertRaises(LogError):
                self.read(data)


class Regions(unittest.TestCase):
    def test_a_cavity_is_what_the_insertion_replaces(self):
        vertices = dict(enumerate(numpy.random.default_rng(1).uniform(-1, 1, (60, 3))))
        point = numpy.array([0.1, 0.2, -0.1])
        mesh = Triangulation.of(vertices)
        cavity = mesh.named_cells(mesh.cavity(point, mesh.spheres()))
        everything = mesh.named_cells(numpy.ones(len(mesh.cells), bool))
        after = Delaunay(numpy.concatenate([list(vertices.values()), [point]])).simplices
        self.assertEqual(everything - cavity, everything & {frozenset(cell) for cell in after.tolist()})
        self.assertGreater(len(cavity), 3)

    def test_a_cut_lies_in_the_plane_and_has_the_area_of_the_box(self):
        corners = numpy.array(list(itertools.product((-1.0, 1), repeat=3)))
        mesh = Triangulation.of(dict(enumerate(numpy.concatenate([corners, [[0.1, 0.2, 0.3]]]))))
        plane = Plane.through(numpy.zeros(3), numpy.array([1.0, 0, 0]), numpy.array([1.0, 1, 0]))
        polygons, owners = plane.cut(mesh, numpy.ones(len(mesh.cells), bool))
        x, y = polygons[..., 0], polygons[..., 1]
        areas = 0.5 * numpy.abs((x * numpy.roll(y, -1, 1) - y * numpy.roll(x, -1, 1)).sum(axis=1))
        self.assertAlmostEqual(areas.sum(), 4, places=6)
        self.assertLess(owners.max(), len(mesh.cells))

    def test_the_label_of_a_point_is_that_of_the_nearest_voxel(self):
        voxels = numpy.arange(8).reshape(2, 2, 2)
        labels = Labels(voxels, numpy.linalg.inv(numpy.diag([2.0, 2, 2, 1])))
        self.assertEqual(labels.at(numpy.array([[0.9, 0, 2.9], [2, 2, 2], [9, 0, 0]])).tolist(), [1, 7, 0])


class Pictures(unittest.TestCase):
    def test_all_are_drawn_of_a_log(self):
        with tempfile.TemporaryDirectory() as name:
            path = Path(name) / "run.log"
            path.write_bytes(random_log(80))
            log = read_log(path)
        voxels = numpy.ones((5, 5, 5), int)
        labels = Labels(voxels, numpy.linalg.inv(numpy.array(
            [[0.5, 0, 0, -1], [0, 0.5, 0, -1], [0, 0, 0.5, -1], [0, 0, 0, 1]])))
        self.assertEqual([len(figure.axes) for figure in (refinement(log, labels), operations(log, labels),
                                                          conflict(log))], [4, 6, 1])


if __name__ == "__main__":
    unittest.main()
