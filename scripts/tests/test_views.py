"""Tests the reading, measuring and drawing of meshes."""
import io
import json
import subprocess
import tempfile
import unittest
from pathlib import Path

import matplotlib.image
import numpy
import paths
import synthetic
from views import colours, cut, quality
from views.mesh import Mesh, MeshError
from views.read_mesh import read_mesh
from views.view import plane_of

XVFB = Path("/usr/bin/Xvfb")
NAMES = {1: "left half", 2: "right half"}


def box(side=3):
    return Mesh(*synthetic.box_mesh(side), NAMES)


def labels_of_cells(mesh):
    """Returns labels by the cells' corners, in any order."""
    return {tuple(sorted(map(tuple, corners))): label for corners, label in zip(mesh.corners(), mesh.labels)}


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, mesh):
        path = self.folder / "mesh.vtu"
        synthetic.write_vtu(path, mesh.points, mesh.cells, mesh.labels)
        return path


class Files(InFolder):
    def test_a_file_holds_the_mesh(self):
        mesh = box()
        self.assertEqual(labels_of_cells(read_mesh(self.write(mesh))), labels_of_cells(mesh))

    def test_a_file_may_hold_colours_of_labels(self):
        path = self.write(box())
        self.assertEqual(read_mesh(path).colours, {})
        text, fields = path.read_text(), '<FieldData><DataArray type="UInt32" Name="label_colours" ' \
            'NumberOfComponents="4" NumberOfTuples="2" format="ascii">1 255 0 51\n2 1 2 3\n</DataArray></FieldData>'
        path.write_text(text.replace("<UnstructuredGrid>", "<UnstructuredGrid>" + fields))
        self.assertEqual(read_mesh(path).colours, {1: "#ff0033", 2: "#010203"})

    def test_what_cannot_be_shown_is_named(self):
        for path, words in ((self.folder / "none.vtu", "none.vtu: No such file"),
                            (self.folder / "mesh.inp", "mesh.inp: not a mesh file that can be shown; convert it"),
                            (self.folder, "not a mesh file")):
            with self.assertRaisesRegex(MeshError, words):
                read_mesh(path)


class Quality(unittest.TestCase):
    def measured(self, *corners):
        mesh = Mesh(numpy.array(corners, float), numpy.arange(4)[None], numpy.array([1]))
        return {name: quality.measured(mesh, name)[0] for name in quality.MEASURES}

    def test_a_regular_tetrahedron(self):
        found = self.measured((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
        self.assertAlmostEqual(found["dihedral"], numpy.degrees(numpy.arccos(1 / 3)))
        self.assertAlmostEqual(found["ratio"], numpy.sqrt(3 / 8))
        self.assertAlmostEqual(found["size"], numpy.sqrt(3))

    def test_a_corner_of_a_cube(self):
        angles = quality.dihedral_angles_deg(numpy.array([[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]], float))
        numpy.testing.assert_allclose(sorted(angles[0]), [numpy.degrees(numpy.arctan(numpy.sqrt(2)))] * 3 + [90] * 3)

    def test_a_flat_cell_has_angles_and_no_circumradius(self):
        found = self.measured((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
        self.assertAlmostEqual(found["dihedral"], 0)
        self.assertTrue(numpy.isnan(found["ratio"]) and numpy.isnan(found["size"]))

    def test_blocks_do_not_matter(self):
        mesh = box(4)
        whole, block = quality.measured(mesh, "ratio"), quality.BLOCK
        self.addCleanup(setattr, quality, "BLOCK", block)
        quality.BLOCK = 7
        numpy.testing.assert_array_equal(quality.measured(mesh, "ratio"), whole)


class Cut(unittest.TestCase):
    def plane(self, flip=False, **changes):
        return plane_of({"normal": [1, 1, 0], "place": 0.4, "is_fraction": True, **changes}, flip)

    def test_both_sides_make_up_the_mesh(self):
        mesh = box()
        for changes in ({}, {"place": 1.1, "is_fraction": False}, {"normal": [0, 0, 5]}):
            sides = [cut.shown_cells(mesh, self.plane(flip, **changes), [], []) for flip in (False, True)]
            numpy.testing.assert_array_equal(numpy.sort(numpy.concatenate(sides)), numpy.arange(len(mesh.cells)))
            self.assertGreater(min(map(len, sides)), 0)

    def test_no_cell_shown_has_its_centre_beyond(self):
        mesh, plane = box(), self.plane(place=1.5, is_fraction=False)
        centers = mesh.corners().mean(axis=1)
        shown = cut.shown_cells(mesh, plane, [], [])
        self.assertTrue((centers[shown, :2].sum(axis=1) <= 1.5 * numpy.sqrt(2)).all())

    def test_labels_go_by_name_or_value(self):
        mesh = box()
        for names, hidden in ((["right half"], []), (["2"], []), ([], ["left half"]), (["1", "2"], ["1"])):
            shown = cut.shown_cells(mesh, None, names, hidden)
            numpy.testing.assert_array_equal(shown, numpy.flatnonzero(mesh.labels == 2))

    def test_what_is_no_label_or_leaves_nothing_is_reported(self):
        mesh = box()
        for plane, names, hidden, words in (
            (None, ["rigt half"], [], "--labels: no label .* called 'rigt half', did you mean 'right half'"),
            (None, [], ["7"], "--hide: no label .* called '7'; it has left half, right half"),
            (None, ["1"], ["1"], "leave no cell"),
            (self.plane(place=-9, is_fraction=False), [], [], "--cut: the plane leaves no cell"),
        ):
            with self.assertRaisesRegex(MeshError, words):
                cut.shown_cells(mesh, plane, names, hidden)


class Colours(unittest.TestCase):
    def test_labels_differ_and_the_largest_is_pale(self):
        count = 1 + 3 * len(colours.PALETTE)
        mesh = box(4)
        many = Mesh(mesh.points, mesh.cells, numpy.minimum(numpy.arange(len(mesh.cells)), count - 1))
        table = colours.colours_of_labels(many)
        self.assertEqual(len(set(table.values())), count)
        self.assertEqual(table[count - 1], colours.PALE)

    def test_a_label_has_its_own_colour_if_the_image_gives_one(self):
        mesh = box(4)
        plain = colours.colours_of_labels(mesh)
        for given in ({2: "#123456"}, {1: "#000000", 2: "#ffffff"}, {9: "#123456"}):
            table = colours.colours_of_labels(Mesh(mesh.points, mesh.cells, mesh.labels, NAMES, given))
            self.assertEqual(table, {value: given.get(value, colour) for value, colour in plain.items()})
            self.assertEqual(list(table), list(plain))

    def test_a_single_label_is_not_pale(self):
        mesh = box(1)
        table = colours.colours_of_labels(Mesh(mesh.points, mesh.cells, mesh.labels * 0))
        self.assertNotEqual(table, {0: colours.PALE})


class Camera(unittest.TestCase):
    def test_axes_are_right_handed_and_face_the_cut(self):
        from views.picture import camera_axes
        for towards in numpy.eye(3).tolist() + (-numpy.eye(3)).tolist() + [[0.6, 0, 0.8]]:
            for angles in ((0, 0), (20, 15), (-70, 60)):
                axes = camera_axes(numpy.array(towards), *angles)
                numpy.testing.assert_allclose(axes @ axes.T, numpy.eye(3), atol=1e-12)
                self.assertAlmostEqual(numpy.linalg.det(axes), 1)
                turned = numpy.degrees(numpy.arccos(numpy.dot(axes[2], towards)))
                if angles == (0, 0):
                    self.assertAlmostEqual(turned, 0, places=5)
                else:
                    self.assertGreater(turned, 10)


@unittest.skipUnless(XVFB.exists(), "xvfb is not installed")
class Picture(InFolder):
    REQUEST = {"cut": {"normal": [0, 1, 0], "place": 0.5, "is_fraction": True}, "flip": False, "labels": [], "hide": [],
               "colour": "label", "camera_deg": [20, 15], "zoom": 1, "size": [320, 240], "background": "#ffffff",
               "legend": False}

    def draw(self, **changes):
        """Returns the picture, height x width x 3, from 0 to 255."""
        request = {**self.REQUEST, "mesh": str(self.write(box())), **changes}
        done = subprocess.run(["/usr/bin/python3", "-E", "-s", "-B", paths.SCRIPTS / "view", json.dumps(request)],
                              capture_output=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return numpy.round(255 * matplotlib.image.imread(io.BytesIO(done.stdout))[..., :3]).astype(int)

    def share_of(self, picture, hue):
        """Returns the share of pixels whose greatest channel is `hue`, by a margin."""
        others = [channel for channel in range(3) if channel != hue]
        return (picture[..., hue] > picture[..., others].max(axis=2) + 20).mean()

    def test_labels_have_their_colours_and_can_be_hidden(self):
        picture = self.draw()
        self.assertEqual(picture.shape, (240, 320, 3))
        self.assertTrue((picture[0, 0] == 255).all())
        self.assertGreater(self.share_of(picture, 0), 0.05)  # red: the smaller label
        self.assertGreater((picture[..., 0] < 255).mean(), 0.3)
        self.assertLess(self.share_of(self.draw(hide=["1"]), 0), 0.01)

    def test_quality_background_and_legend_show(self):
        picture = self.draw(colour="ratio", background="#102030")
        self.assertEqual(picture[0, 0].tolist(), [0x10, 0x20, 0x30])
        with_legend = self.draw(colour="ratio", background="#102030", legend=True, size=[640, 480])
        strip = with_legend[:, 520:].reshape(-1, 3)
        self.assertGreater((strip.min(axis=1) > 150).sum(), 10)  # pixels of its text
        self.assertGreater(len(numpy.unique(strip, axis=0)), 30)  # colours of its ramp


if __name__ == "__main__":
    unittest.main()
