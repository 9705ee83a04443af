"""Tests cuts, leaf grids and schedules, and the mesh in a page."""
import base64
import json
import tempfile
import unittest
import zlib
from pathlib import Path

import numpy
import paths  # noqa: F401
import synthetic
from figures import fig2b
from figures.plane_cut import plane_cut
from figures.schedule import ScheduleError, active_pair, read_schedule, rings
from report_page import viewer
from views.mesh import Mesh, MeshError
from views.read_mesh import read_mesh


def area(polygons):
    x, y = polygons[..., 0], polygons[..., 1]
    return abs((x * numpy.roll(y, -1, axis=1) - numpy.roll(x, -1, axis=1) * y).sum(axis=1) / 2)


class Cut(unittest.TestCase):
    def test_polygons_tile_the_section(self):
        points, cells, _ = synthetic.box_mesh(side=3)
        for height in (0.3, 1.0, 1.7, 2.999):
            polygons, owners = plane_cut(points, cells, height)
            self.assertAlmostEqual(area(polygons).sum(), 9)
            spans = points[cells[owners], 2]
            self.assertTrue(((spans.min(axis=1) < height) & (spans.max(axis=1) >= height)).all())

    def test_a_plane_beside_the_mesh_cuts_nothing(self):
        points, cells, _ = synthetic.box_mesh(side=2)
        self.assertEqual(len(plane_cut(points, cells, 5.0)[0]), 0)


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def schedule(self, rows):
        path = self.folder / "schedule.jsonl"
        path.write_text("".join(json.dumps(row) + "\n" for row in rows))
        return read_schedule(path)

    def test_two_leaves_active_at_one_time_are_found(self):
        schedule = self.schedule(synthetic.schedule(side=9))
        one, other, height = active_pair(schedule)
        self.assertEqual((one["leaf"], other["leaf"], height), (20, 60, 0.5))

    def test_none_when_leaves_are_active_one_after_another(self):
        rows = synthetic.schedule()
        for turn, row in enumerate(rows[1:]):
            row.update(begin_s=turn, end_s=turn + 1)
        self.assertIsNone(active_pair(self.schedule(rows)))

    def test_bad_schedules_are_named(self):
        with self.assertRaisesRegex(ScheduleError, "schema 'podm-schedule/2'"):
            self.schedule([{"schema": "podm-schedule/2"}])
        (self.folder / "schedule.jsonl").write_text('{"schema": "podm-schedule/1"}\n{\n')
        with self.assertRaisesRegex(ScheduleError, "schedule.jsonl:2: not JSON"):
            read_schedule(self.folder / "schedule.jsonl")
        with self.assertRaisesRegex(ScheduleError, "No such file"):
            read_schedule(self.folder / "none.jsonl")

    def test_rings_of_a_uniform_grid(self):
        leaves = numpy.array([[i, j, k, 1] for k in range(7) for j in range(7) for i in range(7)])
        first, second = rings(leaves, 3 + 7 * 3 + 49 * 3)
        self.assertEqual((len(first), len(second)), (26, 125 - 27))

    def test_rings_of_leaves_of_different_sizes(self):
        leaves = numpy.array([[0, 0, 0, 2], [2, 0, 0, 1], [2, 1, 0, 1], [3, 0, 0, 1], [4, 0, 0, 4]])
        first, second = rings(leaves, 0)
        self.assertEqual((list(first), list(second)), ([1, 2], [3]))

    def test_figure_2b(self):
        points, cells, labels = synthetic.box_mesh(side=9)
        schedule = synthetic.schedule(side=9)
        schedule[0]["mesh_to_grid"] = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]
        figure = fig2b.fig2b(self.schedule(schedule), Mesh(points, cells, labels))
        self.assertIn("from 500.00 to 1000.00 ms", figure.get_label())
        self.assertIn("have no leaf in common", figure.get_label())
        self.assertEqual(len(figure.axes[0].get_legend().get_texts()), 6)

    def test_reads_vtu_and_refuses_what_is_none(self):
        points, cells, labels = synthetic.box_mesh(side=2)
        synthetic.write_vtu(self.folder / "mesh.vtu", points, cells, labels)
        mesh = read_mesh(self.folder / "mesh.vtu")
        numpy.testing.assert_array_equal(mesh.points, points)
        numpy.testing.assert_array_equal(mesh.cells, cells)
        numpy.testing.assert_array_equal(mesh.labels, labels)
        (self.folder / "mesh.vtu").write_text("no mesh")
        with self.assertRaisesRegex(MeshError, "mesh.vtu: no cells"):
            read_mesh(self.folder / "mesh.vtu")


class Packed(unittest.TestCase):
    def test_cells_come_back_facing_outwards(self):
        points, cells, labels = synthetic.box_mesh(side=3)
        packed = viewer.pack(Mesh(points, cells, labels))
        data = zlib.decompress(base64.b64decode(packed["data"]))
        split = 6 * packed["points"]
        back = numpy.frombuffer(data[:split], "<u2").reshape(-1, 3) * packed["step_mm"] + packed["low_mm"]
        cells_back = numpy.frombuffer(data[split : split + 16 * packed["cells"]], "<u4").reshape(-1, 4)
        a, b, c, d = (back[cells_back[:, corner]] for corner in range(4))
        volumes = numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), d - a) / 6
        self.assertTrue((volumes > 0).all())
        self.assertAlmostEqual(volumes.sum(), 27, delta=0.01)
        self.assertEqual([(one["value"], one["cells"]) for one in packed["labels"]], [(1, 54), (2, 108)])

    def test_too_many_cells_are_refused(self):
        count = viewer.MAX_CELLS + 1
        mesh = Mesh(numpy.zeros((4, 3)), numpy.broadcast_to(numpy.arange(4), (count, 4)), numpy.zeros(count, int))
        with self.assertRaisesRegex(viewer.TooManyCells, "more than a page can show"):
            viewer.pack(mesh)


if __name__ == "__main__":
    unittest.main()
