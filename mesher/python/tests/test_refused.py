"""Bad input raises an exception that names what was expected."""

import unittest

import nibabel
import numpy as np

from balls import AFFINE, TestCase, balls, podm


class RefusedTest(TestCase):
    def assert_refused(self, *words, labels=None, **keywords):
        with self.assertRaises(podm.Error) as refusal:
            podm.mesh(balls() if labels is None else labels, **keywords)
        for word in words:
            self.assertIn(word, str(refusal.exception))
        self.assertNotIn("--", str(refusal.exception))
        self.assertIsInstance(refusal.exception, ValueError)

    def test_arrays_that_are_no_label_image(self):
        self.assert_refused("labels", "3-D image", "20 x 24 voxels", labels=balls()[:, :, 0])
        self.assert_refused("labels", "3-D image", labels=np.stack([balls(), balls()], axis=-1))
        self.assert_refused("labels", "no voxels", labels=balls()[:0])
        self.assert_refused("labels", "no foreground", labels=np.zeros((4, 4, 4), int))
        for order in "CF":
            self.assert_refused("voxel (8, 8, 2) is -3", labels=np.asarray(-balls(np.int16), order=order))
            self.assert_refused("voxel (8, 8, 2) is 3.5", labels=np.where(balls(order=order) == 3, 3.5, 0))
        self.assert_refused("voxel (0, 0, 0) is nan", labels=np.full((4, 4, 4), np.nan))
        self.assert_refused("no label (an integer, 0 to 2^32 - 1)", labels=balls(np.uint64) + 2**40)
        self.assert_refused("more than 65535 different values", labels=np.arange(8 * 10**4).reshape(20, 40, 100))

    def test_types_that_are_no_numbers_or_too_wide(self):
        for dtype in (complex, "U3", object, np.float16, np.longdouble, "M8[s]"):
            self.assert_refused("labels", "integers is expected", labels=np.ones((4, 4, 4)).astype(dtype))
        for labels in (None, 5, {"a": 1}, [[["x"]]]):
            self.assert_refused("labels", labels=np.array(labels, dtype=object) if labels is None else labels)
        self.assert_refused("labels", "3-D array of integers", labels=[[[1, 2], [3]]])
        self.assert_refused("without a mask", labels=np.ma.masked_equal(balls(), 0))

    def test_affines_that_place_nothing(self):
        self.assert_refused("affine", "4x4", "(3, 3)", affine=np.eye(3))
        self.assert_refused("affine", "4x4", affine="RAS")
        self.assert_refused("last row", affine=np.ones((4, 4)))
        self.assert_refused("labels", "singular", affine=np.eye(4)[:, [0, 0, 1, 3]])
        self.assert_refused("labels", "spacing is not positive", affine=np.diag([1, 1, 0, 1]))
        self.assert_refused("labels", "not finite", affine=np.where(AFFINE == 7.25, np.nan, AFFINE))
        self.assert_refused("labels", "2^33 voxels", affine=np.where(AFFINE == 7.25, 1e13, AFFINE))
        self.assert_refused("spacing", "three", spacing=(1, 2))
        self.assert_refused("spacing", "positive", spacing=(1, 2, 0))
        self.assert_refused("spacing", "three", spacing="isotropic")
        self.assert_refused("spacing", "three", "True", spacing=(1, 1, True))
        self.assert_refused("one of them", affine=AFFINE, spacing=(1, 1, 1))

    def test_a_file_has_an_affine_of_its_own(self):
        path = self.nifti()
        for labels in (path, nibabel.load(path)):
            self.assert_refused("labels", "affine", labels=labels, affine=AFFINE)
            self.assert_refused("labels", "spacing", labels=labels, spacing=(1, 1, 1))

    def test_files_that_are_none_or_faulty(self):
        self.assert_refused("nowhere.nii", labels=self.folder / "nowhere.nii")
        self.assert_refused("unknown image format", labels="image.png")
        (self.folder / "short.nii").write_bytes(self.nifti().read_bytes()[:-10])
        self.assert_refused("short.nii", labels=self.folder / "short.nii")
        self.assert_refused("nobody.txt", names=self.folder / "nobody.txt")
        self.assert_refused("names", '{1: "liver"}', "name of a file", "['liver']", names=["liver"])

    def test_texts_that_would_name_another_file_or_label(self):
        for text in ("no\0pe", "no\ud800pe"):
            self.assert_refused("labels: the name of a file, without NUL", repr(text), labels=text)
            for keyword in ("names", "size_image", "topology"):
                self.assert_refused(f"{keyword}: the name of a file, without NUL", repr(text), **{keyword: text})
            for keyword, value in (("names", {3: text}), ("radius_of", {text: 2}), ("merge", {text: [3]}),
                                   ("keep", text), ("algorithm", text)):
                self.assert_refused(f"{keyword}: text, without NUL", **{keyword: value})
        self.assert_refused("names: text, without NUL", names={3: "\udcff"})

    def test_names_of_no_label(self):
        self.assert_refused("labels: no label 'livr'", "did you mean 'liver'", names={3: "liver"},
                            radius_of={"livr": 1})
        self.assert_refused("names", '{1: "liver"}', names={"liver": 3})
        self.assert_refused("names", names={3: 7})
        self.assert_refused("names", names={-1: "liver"})
        self.assert_refused("names", names={True: "liver"})
        self.assert_refused("keep", "label 5", keep=[5])
        self.assert_refused("keep", "label values", keep=2.5)
        for values in ([], (), np.array([], int), [-1], -1, [2**32], [True], True, np.True_, ["3"]):
            self.assert_refused("keep: one or several label values", keep=values)
            self.assert_refused("drop: one or several label values", drop=values)
            self.assert_refused("merge: one or several label values", merge={"both": values})
        self.assert_refused("merge", merge=[3, 7])
        self.assert_refused("merge: a name is expected, not 5", merge={5: [3, 7]})
        self.assert_refused("radius_of", "name or value", radius_of={-1: 2})
        self.assert_refused("label 3 is the background", keep=[3], background=3)

    def test_options_out_of_range(self):
        self.assert_refused("radius: '-1' is not a positive length in mm", radius=-1)
        self.assert_refused("radius: 'nan'", radius=float("nan"))
        self.assert_refused("radius", "number", radius=[1, 2])
        self.assert_refused("radius_of", "length in mm", radius_of={3: "wide"})
        self.assert_refused("radius_of", "dict", radius_of=2)
        self.assert_refused("radius_of 7", "not a positive length", radius_of={7: 0})
        self.assert_refused("grade: '0' is not a positive number", grade=0)
        self.assert_refused("size_image", "name of a file", size_image=3)
        self.assert_refused("nowhere.nii", size_image=self.folder / "nowhere.nii")
        self.assert_refused("size_near", "dict from pairs", size_near=[3, 7])
        for pair in (3, "liver", (3,), (3, 7, 1), (3, -1)):
            self.assert_refused("size_near: a pair of labels", size_near={pair: 1})
        for size in ("wide", (1, 2, 3), (1, "wide"), True):
            self.assert_refused("size_near: a length in mm", size_near={(3, 7): size})
        self.assert_refused("size_near 3,7", "not a positive width", size_near={(3, 7): (1, 0)})
        self.assert_refused("target_elements", "radius", radius=1, target_elements=1000)
        self.assert_refused("target_tolerance", "target_elements", target_tolerance=3)
        self.assert_refused("target_elements: '2.5' is not an integer", target_elements=2.5)
        self.assert_refused("lines excludes thin keep", "topology", lines=True, thin="keep")
        self.assert_refused("lines excludes optimize", lines=True, optimize=True)
        self.assert_refused("algorithm", "podm-home", algorithm="fast")
        self.assert_refused("space", "voxel", space="MNI")
        self.assert_refused("dihedral_bounds", "pair", optimize=True, dihedral_bounds=8)
        self.assert_refused("dihedral_bounds", "optimize", dihedral_bounds=(8, 165))
        self.assert_refused("delta", "longer than the image", delta=1e4)
        self.assert_refused("1000 workers", "oversubscribe", threads=1000)
        self.assert_refused("max_memory_gib", radius=1e-3)

    def test_truth_is_for_flags_alone_and_flags_are_for_truth(self):
        for value in (True, False, np.True_):
            self.assert_refused(f"radius: a number or a text is expected, not {value!r}", radius=value)
            self.assert_refused("background: a number", background=value)
            self.assert_refused("dihedral_bounds: a pair of numbers", dihedral_bounds=(value, 165))
            self.assert_refused("radius_of: a length", radius_of={3: value})
        for value in ("yes", "", 1, 0, [True]):
            for keyword in ("optimize", "oversubscribe"):
                self.assert_refused(f"{keyword}: True or False is expected, not {value!r}", **{keyword: value})

    def test_a_keyword_that_is_none(self):
        with self.assertRaises(TypeError):
            podm.mesh(balls(), raduis=3)

    def test_a_mesh_is_written_whole_or_not_at_all(self):
        mesh = podm.mesh(balls())
        for path, *words in (("mesh.obj", "mesh.obj"), ("nowhere/mesh.vtu", "nowhere/mesh")):
            with self.assertRaises(podm.Error) as refusal:
                mesh.save(self.folder / path)
            self.assertIn(*words, str(refusal.exception))
        with self.assertRaises(podm.Error):
            mesh.save_surfaces(self.folder / "surface.vtu")
        for save in (mesh.save, mesh.save_surfaces):
            for path in (f"{self.folder}/precious\0.vtu", f"{self.folder}/\ud800.vtu", 5, None):
                with self.assertRaisesRegex(podm.Error, "path: the name of a file, without NUL"):
                    save(path)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_versions_that_gmsh_has_not_and_files_that_are_not_its(self):
        mesh = podm.mesh(balls())
        for name, version, words in (("mesh.msh", 3, "gmsh_version: '3' is not one of 4.1 or 2.2"),
                                     ("mesh.msh", True, "gmsh_version: a number or a text is expected, not True"),
                                     ("mesh.vtu", 2.2, "a version of Gmsh's format is for .msh alone")):
            with self.assertRaisesRegex(podm.Error, words):
                mesh.save(self.folder / name, gmsh_version=version)
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
