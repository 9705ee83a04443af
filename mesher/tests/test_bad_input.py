"""Faulty images, options that do not suit the image, and outputs that cannot be written give exit code 2 and a message
that names the file and the fault, and leave no file behind."""

import gzip
import os
import struct
import unittest

import small_images
from podm_process import PodmTestCase, run_podm

SIZE = 12
BALL = small_images.ball_voxels(SIZE)


class BadImage(PodmTestCase):
    def assert_image_refused(self, path, *words):
        self.assert_refused(["info", path], path.name, *words)
        self.assert_refused(["mesh", path, "-o", self.folder / "out.mesh", "--record", self.folder / "runs.jsonl"],
                            path.name, *words)

    def nifti(self, name, *arguments, **options):
        return small_images.write_nifti(self.folder / name, *arguments, **options)

    def test_a_sound_image_is_accepted(self):
        self.assert_exit(run_podm("info", self.nifti("sound.nii", BALL)), 0)
        self.assert_exit(run_podm("info", small_images.write_metaimage(self.folder / "sound.mha", BALL)), 0)

    def test_missing(self):
        self.assert_image_refused(self.folder / "missing.nii")

    def test_a_folder(self):
        folder = self.folder / "folder.nii"
        folder.mkdir()
        self.assert_image_refused(folder)

    def test_empty(self):
        for name in ("empty.nii", "empty.nii.gz", "empty.nrrd", "empty.mha", "empty.inr"):
            with self.subTest(name=name):
                (self.folder / name).touch()
                self.assert_image_refused(self.folder / name)

    def test_unknown_format(self):
        (self.folder / "image.txt").write_bytes(b"not an image")
        self.assert_image_refused(self.folder / "image.txt")

    def test_wrong_magic(self):
        self.assert_image_refused(self.nifti("magic.nii", BALL, magic=b"abcd"))

    def test_header_larger_than_its_data(self):
        self.assert_image_refused(self.nifti("short.nii", BALL[:-1]))
        self.assert_image_refused(small_images.write_metaimage(self.folder / "short.mha", BALL[:-1]))

    def test_truncated_gzip(self):
        whole = gzip.compress(self.nifti("whole.nii", BALL).read_bytes())
        for kept in (5, len(whole) // 2, len(whole) - 9):
            with self.subTest(kept=kept):
                path = self.folder / f"cut{kept}.nii.gz"
                path.write_bytes(whole[:kept])
                self.assert_image_refused(path)

    def test_spacing(self):
        for spacing in ("0 1 1", "1 -1 1", "1 1 nan"):
            with self.subTest(spacing=spacing):
                path = self.folder / "spacing.mha"
                small_images.write_metaimage(path, BALL, spacing=spacing)
                self.assert_image_refused(path)

    def test_singular_affine(self):
        self.assert_image_refused(self.nifti("flat.nii", BALL, affine=((1, 1, 0, 0), (1, 1, 0, 0), (0, 0, 1, 0))))

    def test_dimensions(self):
        self.assert_image_refused(self.nifti("two.nii", BALL[:SIZE * SIZE], dimensions=(SIZE, SIZE)))
        self.assert_image_refused(self.nifti("four.nii", BALL * 2, dimensions=(SIZE, SIZE, SIZE, 2)))

    def test_colours_and_grey_scale(self):
        self.assert_image_refused(self.nifti("rgb.nii", BALL * 3, datatype=small_images.RGB24))
        grey = struct.pack(f"<{SIZE ** 3}f", *(0.5 * voxel for voxel in BALL))
        self.assert_image_refused(self.nifti("grey.nii", grey, datatype=small_images.FLOAT32))

    def test_no_foreground(self):
        self.assert_image_refused(self.nifti("nothing.nii", bytes(SIZE ** 3)))

    def test_unknown_phantom(self):
        for name in ("phantom:sphere", "phantom:", "phantom:spheres@", "phantom:spheres@x", "phantom:spheres@0",
                     "phantom:spheres@999999"):
            with self.subTest(name=name):
                self.assert_refused(["info", name], name)
        self.assert_refused(["phantom", "sphere", "-o", self.folder / "p.nii"], "sphere")


class BadOptionsForTheImage(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.image = small_images.write_nifti(self.folder / "ball.nii", BALL)
        self.out = self.folder / "out.mesh"

    def assert_mesh_refused(self, options, *words):
        return self.assert_refused(["mesh", self.image, "-o", self.out, *options], *words)

    def test_absent_labels(self):
        self.assert_mesh_refused(["--labels", "7"], self.image.name, "7")
        self.assert_mesh_refused(["--radius-of", "7=2"], self.image.name, "7")
        self.assert_mesh_refused(["--radius-of", "liver=2"], self.image.name, "liver")
        self.assert_mesh_refused(["--merge", "1,7=both"], self.image.name, "7")
        self.assert_mesh_refused(["--drop", "1"], self.image.name)

    def test_label_names(self):
        self.assert_mesh_refused(["--label-names", self.folder / "missing.txt"], "missing.txt")
        (self.folder / "empty.txt").touch()
        self.assert_mesh_refused(["--label-names", self.folder / "empty.txt"], "empty.txt")
        (self.folder / "colours.txt").write_text("#No. Label Name: R G B A\n1 liver 1 2 3 0\n2 spleen 1 2 300 0\n")
        self.assert_mesh_refused(["--label-names", self.folder / "colours.txt"], "colours.txt:3", "VALUE NAME R G B A")
        (self.folder / "unknown.txt").write_text("Value,Name\n1,liver\n")
        self.assert_mesh_refused(["--label-names", self.folder / "unknown.txt"], "unknown.txt:1", "no known format")

    def test_labels_of_64_bits_outside_the_range(self):
        for value, shown in ((-1, "-1"), (2**32, "4294967296"), (2**63 - 1, "9223372036854775807")):
            voxels = struct.pack("<64q", *([1] * 63), value)
            for image in (
                    small_images.write_nifti(self.folder / "a.nii", voxels, (4, 4, 4), small_images.INT64),
                    small_images.write_nrrd(self.folder / "a.nrrd", voxels, 4, "int64"),
                    small_images.write_metaimage(self.folder / "a.mha", voxels, 4, element_type="MET_LONG_LONG")):
                with self.subTest(value=value, name=image.name):
                    self.assert_refused(["mesh", image, "-o", self.out], f"{image.name}: ",
                                        f"voxel (3, 3, 3) is {shown}, no label")

    def test_absurdly_small_sizes_are_refused_with_an_estimate(self):
        for options in (["--radius", "1e-5"], ["--radius", "1e-300"], ["--delta", "1e-6"],
                        ["--radius-of", "1=1e-5"], ["--target-elements", "4000000000", "--max-memory-gib", "4"]):
            with self.subTest(options=options):
                process = self.assert_mesh_refused(options, self.image.name, "GiB", "cells")
                self.assertRegex(process.stderr, r"about \S+ cells and \S+ GiB")

    def test_absurdly_large_delta(self):
        self.assert_mesh_refused(["--delta", "1000"], "delta")

    def test_memory_limit_below_the_estimate(self):
        self.assert_mesh_refused(["--max-memory-gib", "1e-6"], self.image.name, "GiB")


class BadOutput(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.image = small_images.write_nifti(self.folder / "ball.nii", BALL)

    def mesh(self, *arguments):
        return ["mesh", self.image, *arguments]

    def test_unknown_extension(self):
        self.assert_refused(self.mesh("-o", self.folder / "out.stl"), "out.stl", ".vtu")
        self.assert_refused(self.mesh("-o", self.folder / "out"), "out", ".vtu")
        self.assert_refused(self.mesh("-o", self.folder / "out.vtu", "--surface", self.folder / "s.obj"), "s.obj",
                            ".stl")
        self.assert_refused(["phantom", "spheres", "--size", "16", "-o", self.folder / "p.png"], "p.png")

    def test_missing_folder(self):
        gone = self.folder / "gone"
        self.assert_refused(self.mesh("-o", gone / "out.vtu"), "gone/out.vtu")
        out = self.folder / "out.vtu"
        self.assert_refused(self.mesh("-o", out, "--surface", gone / "s.stl"), "gone/s.stl")
        self.assert_refused(self.mesh("-o", out, "--record", gone / "runs.jsonl"), "gone/runs.jsonl")
        self.assert_refused(self.mesh("-o", out, "--log", gone / "run.log"), "gone/run.log")
        self.assert_refused(self.mesh("-o", out, "--algorithm", "pdr", "--schedule", gone / "leaves.jsonl"),
                            "gone/leaves.jsonl")
        self.assert_refused(["phantom", "spheres", "--size", "16", "-o", gone / "p.nii.gz"], "gone/p.nii.gz")

    def test_a_folder_in_the_way(self):
        (self.folder / "out.vtu").mkdir()
        self.assert_refused(self.mesh("-o", self.folder / "out.vtu"), "out.vtu")
        self.assert_refused(self.mesh("-o", self.folder / "a.vtu", "--record", self.folder), self.folder)

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_a_folder_without_permission(self):
        locked = self.folder / "locked"
        locked.mkdir(mode=0o555)
        self.assert_refused(self.mesh("-o", locked / "out.vtu"), "locked/out.vtu")


if __name__ == "__main__":
    unittest.main()
