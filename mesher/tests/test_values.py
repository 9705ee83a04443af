"""podm mesh --values: values of other images on the cells of a .vtu, and what is refused."""

import re
import unittest

import numpy as np

from podm_process import PodmTestCase, run_podm
from small_images import FLOAT32, INT16, UINT8, write_nifti

TYPES = {"Float64": np.float64, "Int32": np.int32, "UInt32": np.uint32}
SIZE = (15, 14, 13)  # voxels in x, y, z
# Finer voxels than those of the labels, in a turned frame, around all of the object.
FINE = ((0.6, -0.1, 0, -3), (0.1, 0.6, 0, -4), (0, 0, 0.5, -2))
FINE_SIZE = (36, 34, 34)


def arrays_of(path):
    """Returns the appended arrays of a .vtu by name, flat."""
    head, _, tail = path.read_bytes().partition(b'<AppendedData encoding="raw">\n_')
    arrays = {}
    for kind, name, offset in re.findall(rb'<DataArray type="(\w+)" Name="([^"]+)" [^>]*offset="(\d+)"', head):
        if kind.decode() in TYPES:
            begin = int(offset)
            size = int(np.frombuffer(tail[begin:begin + 8], np.uint64)[0])
            arrays[name.decode()] = np.frombuffer(tail[begin + 8:begin + 8 + size], TYPES[kind.decode()])
    return arrays


def volumes_of(arrays):
    corners = arrays["Points"].reshape(-1, 3)[arrays["connectivity"].reshape(-1, 4)]
    return np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6


class Values(PodmTestCase):
    def labels(self):
        """Returns an image in which all voxels have one of two labels."""
        z, y, x = np.indices(SIZE[::-1])
        voxels = np.where(x + 0.4 * y - 0.3 * z < 7, 1, 2).astype(np.uint8)
        return write_nifti(self.folder / "labels.nii", voxels.tobytes(), SIZE, UINT8)

    def values(self, name, size=SIZE, affine=None, voxels=None):
        if voxels is None:
            voxels = np.random.default_rng(1).integers(-1000, 2000, size[::-1])
        write_nifti(self.folder / name, voxels.astype(np.int16).tobytes(), size, INT16, affine=affine)
        return voxels

    def mesh(self, *arguments, radius=4, threads=2, output="a.vtu"):
        process = run_podm("mesh", self.labels(), "-o", self.folder / output, "--radius", radius, "--threads",
                           threads, "--oversubscribe", *arguments)
        self.assert_exit(process, 0)
        return arrays_of(self.folder / output), process.stderr

    def test_a_mesh_that_fills_the_box_has_the_sum_of_the_voxels(self):
        voxels = self.values("ct.nii")
        for space in "RAS", "LPS", "voxel":
            arrays, text = self.mesh("--box", "flat", "--space", space, "--values", f"HU={self.folder}/ct.nii")
            volumes = volumes_of(arrays)
            self.assertAlmostEqual(volumes.sum() / voxels.size, 1, delta=1e-12)
            self.assertAlmostEqual((arrays["HU"] * volumes).sum() / np.abs(voxels).sum(),
                                   voxels.sum() / np.abs(voxels).sum(), delta=1e-10)
            self.assertTrue((arrays["HU_covered"] == 1).all())
            self.assertTrue((arrays["HU_least"] <= arrays["HU"]).all())
            self.assertTrue((arrays["HU"] <= arrays["HU_largest"]).all())
            self.assertEqual((arrays["HU_least"].min(), arrays["HU_largest"].max()), (voxels.min(), voxels.max()))
            self.assertIn("values     HU of ", text)
            self.assertNotIn("covered in part", text)

    def test_trilinear_values_of_a_linear_field_are_those_at_the_centroids(self):
        z, y, x = np.indices(FINE_SIZE[::-1])
        self.values("fine.nii", FINE_SIZE, FINE, 3 * x - 7 * y + 5 * z)
        self.values("ct.nii")
        arrays, _ = self.mesh("--values-of", "trilinear", "--values", f"L={self.folder}/fine.nii",
                              "--values", f"HU={self.folder}/ct.nii")
        corners = arrays["Points"].reshape(-1, 3)[arrays["connectivity"].reshape(-1, 4)]
        matrix = np.array(FINE, dtype=np.float32).astype(float)  # NIfTI holds single precision
        at = np.linalg.solve(matrix[:, :3], (corners.mean(axis=1) - matrix[:, 3]).T).T
        np.testing.assert_allclose(arrays["L"], at @ (3, -7, 5), atol=1e-9)
        self.assertEqual(len(arrays["HU"]), len(arrays["L"]))

    def test_the_mesh_is_that_without_values(self):
        self.values("ct.nii")
        self.mesh("--record", self.folder / "a.jsonl", threads=1)
        self.mesh("--record", self.folder / "b.jsonl", "--values", f"HU={self.folder}/ct.nii", threads=1)
        with_values = self.read_record(self.folder / "b.jsonl")
        self.assertEqual(self.read_record(self.folder / "a.jsonl")["mesh_sha256"], with_values["mesh_sha256"])
        self.assertEqual([(one["name"], one["partly_covered"]) for one in with_values["values"]], [("HU", 0)])

    def test_cells_that_are_covered_in_part_are_counted(self):
        self.values("part.nii", (15, 14, 11), ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 1)))
        arrays, text = self.mesh("--values", f"HU={self.folder}/part.nii", "--delta", 4, radius=8)
        partly = (arrays["HU_covered"] < 1).sum()
        self.assertGreater(partly, 0)
        self.assertIn(f"{partly} cells are covered in part", text)

    def refused(self, *arguments, output="a.vtu"):
        """The last argument is the list of words that the message must have."""
        self.assert_refused(["mesh", self.labels(), "-o", self.folder / output, "--radius", 2, "--quiet",
                             *arguments[:-1]], *arguments[-1])

    def test_what_cannot_be_is_refused_by_name(self):
        self.values("ct.nii")
        self.values("away.nii", affine=((1, 0, 0, 40), (0, 1, 0, 0), (0, 0, 1, 0)))
        self.values("small.nii", (4, 4, 4))
        nan = np.full(SIZE[::-1], np.nan, np.float32)
        write_nifti(self.folder / "nan.nii", nan.tobytes(), SIZE, FLOAT32)
        ct = f"HU={self.folder}/ct.nii"
        self.refused("--values", "HU", ["--values", "NAME=FILE"])
        self.refused("--values", f"HU={self.folder}/none.nii", ["none.nii"])
        self.refused("--values", f"HU={self.folder}/nan.nii", ["nan.nii", "voxel (0, 0, 0)", "finite"])
        self.refused("--values", f"HU={self.folder}/away.nii", ["away.nii", "overlaps no voxel"])
        self.refused("--values", f"HU={self.folder}/small.nii", ["small.nii", "does not overlap", "cells"])
        self.refused("--values", ct, "--values", ct, ["--values", "'HU'"])
        self.refused("--values", f"label={self.folder}/ct.nii", ["--values", "'label'"])
        self.refused("--values-of", "trilinear", ["--values-of", "--values"])
        self.refused("--values", ct, "--values-of", "cubic", ["--values-of", "cubic"])
        self.refused("--values", ct, ["--values", "a.inp", ".vtu"], output="a.inp")


if __name__ == "__main__":
    unittest.main()
