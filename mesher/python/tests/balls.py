"""Small images for the tests, and the program for comparison."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import nibabel
import numpy as np

import podm

PROGRAM = os.environ["PODM_PROGRAM"]
# The axes are reversed and exchanged; a NIfTI header holds the matrix exactly.
AFFINE = np.array([[-0.75, 0, 0, 12], [0, 0, 1.5, -20], [0, 1, 0, 7.25], [0, 0, 0, 1]])


def balls(dtype=np.uint8, order="C"):
    """Returns two balls that touch, with values 3 and 7, in an image whose axes all differ; shape (20, 24, 14)."""
    i, j, k = np.ogrid[:20, :24, :14]
    image = np.zeros((20, 24, 14), dtype=dtype, order=order)
    image[(i - 8) ** 2 + (j - 8) ** 2 + (k - 7) ** 2 <= 25] = 3
    image[(i - 11) ** 2 + (j - 15) ** 2 + (k - 6) ** 2 <= 20] = 7
    return image


def hash_of(mesh):
    return mesh.record["mesh_sha256"]


class TestCase(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def nifti(self, image=None, affine=AFFINE):
        path = self.folder / "image.nii"
        nibabel.save(nibabel.Nifti1Image(balls() if image is None else image, affine), path)
        return path

    def record_of_program(self, image, *options):
        """Returns the record of a run of the program on the file, also if the run misses guarantees."""
        record = self.folder / "record.jsonl"
        subprocess.run([PROGRAM, "mesh", image, "-o", self.folder / "by_program.vtu", "--record", record, "--quiet",
                        *map(str, options)], capture_output=True, check=False)
        return json.loads(record.read_text())

    def assert_valid(self, mesh):
        """Checks that cells are positive, that at most two cells share a facet, and that facets are listed where labels
        change."""
        corners = mesh.points[mesh.cells]
        determinants = np.linalg.det(corners[:, 1:] - corners[:, :1])
        self.assertGreater(determinants.min(), 0)
        sides = np.sort(np.concatenate([np.delete(mesh.cells, v, axis=1) for v in range(4)]), axis=1)
        labels = np.tile(mesh.labels, 4)
        facets, place, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
        self.assertLessEqual(count.max(), 2)
        least, largest = np.full(len(facets), 2**32), np.full(len(facets), -1)
        np.minimum.at(least, place, labels)
        np.maximum.at(largest, place, labels)
        changes = facets[(count == 1) | (least != largest)]
        np.testing.assert_array_equal(np.unique(np.sort(mesh.facets, axis=1), axis=0), changes)


__all__ = ["AFFINE", "PROGRAM", "TestCase", "balls", "hash_of", "podm"]
