"""Input images: arrays of any integer type and memory order, files, images of nibabel."""

import unittest
import warnings

import nibabel
import numpy as np

from balls import AFFINE, TestCase, balls, hash_of, podm


class ImagesTest(TestCase):
    def test_an_array_gives_the_mesh_of_the_file_that_holds_it(self):
        of_program = self.record_of_program(self.nifti(), "--radius", 2, "--threads", 1)
        mesh = podm.mesh(balls(), affine=AFFINE, radius=2, threads=1)
        self.assertEqual(hash_of(mesh), of_program["mesh_sha256"])
        self.assert_valid(mesh)

    def test_a_file_and_an_image_of_nibabel_give_the_same_mesh(self):
        path = self.nifti()
        expected = hash_of(podm.mesh(balls(), affine=AFFINE))
        for labels in (path, str(path), nibabel.load(path), nibabel.Nifti1Image(balls(np.int16), AFFINE)):
            self.assertEqual(hash_of(podm.mesh(labels)), expected)

    def test_every_integer_type_and_memory_order_gives_the_same_mesh(self):
        expected = hash_of(podm.mesh(balls()))
        for dtype in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8", ">i2", ">u4"):
            for order in "CF":
                self.assertEqual(hash_of(podm.mesh(balls(dtype, order))), expected, (dtype, order))

    def test_views_of_any_strides_are_read_as_they_are(self):
        image = balls(np.uint16)
        larger = np.full((60, 24, 28), 9, np.uint16)
        larger[1::3, :, ::2] = image
        turned = np.ascontiguousarray(image[::-1, :, ::-1])[::-1, :, ::-1]
        exchanged = np.ascontiguousarray(image.transpose(1, 2, 0)).transpose(2, 0, 1)
        record = np.zeros(image.shape, [("other", "u1"), ("label", "u2")])
        record["label"] = image
        expected = hash_of(podm.mesh(image))
        for view in (larger[1::3, :, ::2], turned, exchanged, record["label"], image[..., np.newaxis]):
            self.assertEqual(hash_of(podm.mesh(view)), expected, view.strides)

    def test_an_image_larger_than_a_block_of_each_axis_is_read_alike_in_both_orders(self):
        image = np.random.default_rng(1).integers(0, 5, (70, 33, 101)).astype(np.int32)
        for labels in (image, np.asfortranarray(image)):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # a warning about the limit
                voxels = podm.mesh(labels, max_elements=50_000, threads=2)._made.voxels
            np.testing.assert_array_equal(voxels, image.ravel(order="F"))

    def test_booleans_are_labels_0_and_1(self):
        mesh = podm.mesh(balls() > 0)
        self.assertEqual(set(mesh.labels), {1})

    def test_large_values_stay_as_they_are(self):
        image = balls(np.uint32)
        image[image == 7] = 2**32 - 1
        self.assertEqual(set(podm.mesh(image).labels), {3, 2**32 - 1})

    def test_the_array_is_neither_changed_nor_kept(self):
        image = balls()
        before = image.copy()
        mesh = podm.mesh(image)
        np.testing.assert_array_equal(image, before)
        expected = mesh.points.copy()
        image[:] = 0
        np.testing.assert_array_equal(mesh.points, expected)
        self.assertTrue(mesh.verify())

    def test_spacing_is_a_diagonal_affine(self):
        by_affine = podm.mesh(balls(), affine=np.diag([0.5, 2, 1.25, 1]))
        self.assertEqual(hash_of(podm.mesh(balls(), spacing=(0.5, 2, 1.25))), hash_of(by_affine))

    def test_points_lie_where_the_affine_says(self):
        mesh = podm.mesh(balls(), affine=AFFINE, radius=1)
        for value in (3, 7):
            voxels = np.argwhere(balls() == value)
            expected = voxels.mean(axis=0) @ AFFINE[:3, :3].T + AFFINE[:3, 3]
            cells = mesh.cells[mesh.labels == value]
            weights = mesh.quality()["volume"][mesh.labels == value]
            center = np.average(mesh.points[cells].mean(axis=1), axis=0, weights=weights)
            np.testing.assert_allclose(center, expected, atol=0.3)

    def test_a_sheared_affine_is_meshed_as_by_the_program_which_warns_what_shear_spoils(self):
        sheared = AFFINE @ np.array([[1, 0.5, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        of_program = self.record_of_program(self.nifti(affine=sheared), "--radius", 2)
        with self.assertWarnsRegex(UserWarning, "radius-edge ratio"):
            mesh = podm.mesh(balls(), affine=sheared, radius=2)
        self.assert_valid(mesh)
        self.assertEqual(hash_of(mesh), of_program["mesh_sha256"])
        self.assertEqual(mesh.record["guarantees"], of_program["guarantees"])
        volume = podm.mesh(balls(), affine=AFFINE, radius=2).quality()["volume"].sum()
        np.testing.assert_allclose(mesh.quality()["volume"].sum(), volume, rtol=0.05)

    def test_nibabels_unit_is_respected(self):
        image = nibabel.Nifti1Image(balls(), AFFINE)
        image.header.set_xyzt_units("micron")
        in_mm = podm.mesh(balls(), affine=AFFINE).points
        for extreme in (np.min, np.max):
            np.testing.assert_allclose(extreme(podm.mesh(image).points, 0) * 1000, extreme(in_mm, 0), atol=0.5)

    def test_labels_are_chosen_merged_and_named_as_by_the_program(self):
        path = self.nifti()
        named = self.folder / "names.txt"
        named.write_text("3 liver\n7 spleen\n")
        self.assertEqual(podm.mesh(path, names=named).names, {3: "liver", 7: "spleen"})
        for labels in (path, balls()):
            self.assertEqual(podm.mesh(labels, names={3: "liver"}).names, {3: "liver", 7: "label 7"})
            self.assertEqual(podm.mesh(labels, keep=[3]).names, {3: "label 3"})
            self.assertEqual(podm.mesh(labels, keep="1-5").names, {3: "label 3"})
            self.assertEqual(podm.mesh(labels, drop=3).names, {7: "label 7"})
            self.assertEqual(podm.mesh(labels, merge={"both": [3, 7]}).names, {3: "both"})

    def segmentation(self):
        """Returns a .seg.nrrd whose second layer covers a part of the first; both have the value 1."""
        first, second = (balls() == 3).astype(np.uint8), np.zeros_like(balls())
        second[6:9] = 1
        fields = ["NRRD0004", "type: unsigned char", "dimension: 4", "space: left-posterior-superior",
                  "sizes: 2 20 24 14", "space directions: none (1,0,0) (0,1,0) (0,0,1)",
                  "kinds: list domain domain domain", "encoding: raw", "space origin: (0,0,0)",
                  "Segment0_Name:=liver", "Segment0_LabelValue:=1", "Segment0_Layer:=0", "Segment0_Color:=1 0 0.2",
                  "Segment1_Name:=slab", "Segment1_LabelValue:=1", "Segment1_Layer:=1"]
        path = self.folder / "liver.seg.nrrd"
        path.write_bytes("\n".join([*fields, "", ""]).encode() + np.stack([first, second]).tobytes("F"))
        return path

    def test_segments_bring_names_colours_and_layers(self):
        path = self.segmentation()
        with self.assertWarnsRegex(UserWarning, "segments of different layers share label values"):
            mesh = podm.mesh(path)
        self.assertEqual((mesh.names, mesh.colours), ({1: "liver", 2: "slab"}, {1: (255, 0, 51)}))
        self.assertEqual(mesh.record["options"]["labels"]["layers"], [])
        for layers, names in (("0", {1: "liver"}), (0, {1: "liver"}), ([1, 0], {1: "liver", 2: "slab"}),
                              (np.array([1]), {2: "slab"})):
            with self.assertWarns(UserWarning):
                self.assertEqual(podm.mesh(path, layers=layers).names, names)
        with self.assertWarnsRegex(UserWarning, "; layers sets the order of layers"):
            podm.mesh(path, layers=[0, 1])
        for layers in ([2], [0, 0], "a", [0.5], {}, -1):
            with self.assertRaisesRegex(podm.Error, "layers"):
                podm.mesh(path, layers=layers)
        with self.assertRaisesRegex(podm.Error, "labels: layers: the image has no layers"):
            podm.mesh(balls(), layers=[0])

    def test_a_file_of_names_has_colours(self):
        table = self.folder / "lut.txt"
        table.write_text("#No. Label Name: R G B A\n3 Liver 221 130 101 0\n7 Spleen 157 108 162 0\n")
        mesh = podm.mesh(balls(), names=table)
        self.assertEqual(mesh.names, {3: "Liver", 7: "Spleen"})
        self.assertEqual(mesh.colours, {3: (221, 130, 101), 7: (157, 108, 162)})
        self.assertEqual(podm.mesh(balls()).colours, {})

    def test_numpys_numbers_and_truth_are_as_good_as_pythons(self):
        expected = hash_of(podm.mesh(balls(), radius=1.5, keep=[3], optimize=True))
        found = podm.mesh(balls(), radius=np.float32(1.5), keep=np.array([3], np.uint8), optimize=np.True_,
                          oversubscribe=np.False_)
        self.assertEqual(hash_of(found), expected)
        self.assertNotEqual(hash_of(podm.mesh(balls(), radius=1.5, keep=np.uint8(3), optimize=np.False_)), expected)

    def test_another_background_is_outside(self):
        image = balls()
        mesh = podm.mesh(image[4:16, 4:19, 3:11], background=3)
        self.assertEqual(mesh.background, 3)
        self.assertEqual(set(mesh.names), {0, 7})
        self.assertEqual(set(mesh.facet_labels[:, 0]), {3, 0} & set(mesh.facet_labels[:, 0]) | {3})
        self.assertTrue(mesh.verify())

    def test_a_phantom_is_a_file_that_needs_none(self):
        of_program = self.record_of_program("phantom:spheres@24", "--radius", 5)
        self.assertEqual(hash_of(podm.mesh("phantom:spheres@24", radius=5)), of_program["mesh_sha256"])


if __name__ == "__main__":
    unittest.main()
