"""Tests the components of an image and of a mesh that scripts/check_plan compares."""
import tempfile
import unittest
from pathlib import Path

import numpy

import paths  # noqa: F401
from plan_check.lost import circumcenters, image_components, mesh_components, pieces_of_components
from plan_check.volume import read_volume
from views.mesh import Mesh

# Two regular tetrahedra that share a facet, one of them in the other label's region, and a separate third one.
POINTS = numpy.array([[0, 0, 0], [2, 2, 0], [2, 0, 2], [0, 2, 2], [8 / 3, 8 / 3, 8 / 3], [10, 10, 10], [12, 12, 10],
                      [12, 10, 12], [10, 12, 12]])
CELLS = numpy.array([[0, 1, 2, 3], [1, 2, 3, 4], [5, 6, 7, 8]])
AFFINE = numpy.hstack([numpy.eye(3), numpy.zeros((3, 1))])


class Lost(unittest.TestCase):
    def test_faces_join_voxels_and_corners_do_not(self):
        volume = numpy.zeros((4, 4, 4), int)
        volume[0, 0, 0] = volume[1, 1, 0] = volume[0, 1, 3] = 5
        volume[0, 1, 0] = 7
        number, labels = image_components(volume)
        self.assertEqual(sorted(labels), [5, 5, 5, 7])
        self.assertEqual((number >= 0).sum(), 4)
        volume[1, 0, 0] = 5
        self.assertEqual(sorted(image_components(volume)[1]), [5, 5, 7])

    def test_cells_of_one_label_are_joined_by_facets(self):
        for labels, count in ([1, 1, 1], 2), ([1, 2, 1], 3):
            self.assertEqual(len(set(mesh_components(CELLS, numpy.array(labels)))), count)

    def test_circumcentres_are_equally_far(self):
        distances = numpy.linalg.norm(POINTS[CELLS] - circumcenters(POINTS, CELLS)[:, None], axis=2)
        self.assertTrue(numpy.allclose(distances, distances[:, :1]))

    def test_a_component_is_lost_whole_or_cut(self):
        volume = numpy.ones((13, 13, 13), int)
        volume[:, :, 6] = 0
        volume[0, 12, 0] = 3
        number, labels = image_components(volume)
        mesh = Mesh(POINTS, CELLS, numpy.array([1, 1, 1]))
        pieces = pieces_of_components(volume, number, len(labels), AFFINE, mesh)
        for voxel, expected in ((0, 0, 0), 1), ((0, 0, 12), 1), ((0, 12, 0), 0):
            self.assertEqual(pieces[number[voxel]], expected, voxel)
        volume[:] = 1
        number, labels = image_components(volume)
        self.assertEqual(list(pieces_of_components(volume, number, 1, AFFINE, mesh)), [2])


class Volume(unittest.TestCase):
    def test_a_nifti_is_read_x_fastest(self):
        header = bytearray(352)
        header[:4] = (348).to_bytes(4, "little")
        header[40:56] = numpy.array([3, 2, 3, 4, 1, 1, 1, 1], "<i2").tobytes()
        header[70:72] = (4).to_bytes(2, "little")
        header[108:112] = numpy.array([352], "<f4").tobytes()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.nii"
            path.write_bytes(bytes(header) + numpy.arange(24, dtype="<i2").tobytes())
            volume = read_volume(path)
        self.assertEqual(volume.shape, (2, 3, 4))
        self.assertEqual(volume[1, 2, 3], 23)
        self.assertEqual(volume[1, 0, 0], 1)


if __name__ == "__main__":
    unittest.main()
