"""podm info and podm phantom: their output is consistent."""

import json
import unittest

import small_images
from podm_process import PodmTestCase, run_podm


class Info(PodmTestCase):
    def info(self, *arguments):
        process = run_podm("info", "--json", *arguments)
        self.assert_exit(process, 0)
        return json.loads(process.stdout)

    def test_counts_and_volumes_of_a_phantom_add_up(self):
        info = self.info("phantom:abdomen@48")
        voxels = info["size"][0] * info["size"][1] * info["size"][2]
        self.assertEqual(max(info["size"]), 48)
        self.assertEqual(info["background"]["voxels"] + sum(label["voxels"] for label in info["labels"]), voxels)
        self.assertGreaterEqual(len(info["labels"]), 12)
        for label in info["labels"]:
            self.assertGreater(label["voxels"], 0)
            self.assertAlmostEqual(label["volume_mm3"], label["voxels"] * info["voxel_volume_mm3"], delta=1e-6)
        columns = [sum(row[axis] ** 2 for row in info["affine"]) ** 0.5 for axis in range(3)]
        for column, spacing in zip(columns, info["spacing_mm"]):
            self.assertAlmostEqual(column, spacing, places=6)

    def test_volume_of_a_sheared_voxel_is_the_determinant(self):
        path = self.folder / "sheared.nii"
        small_images.write_nifti(path, small_images.ball_voxels(12),
                                 affine=((2, 1, 0, 5), (0, 3, 0, 6), (0, 0, -1, 7)))
        self.assertAlmostEqual(self.info(path)["voxel_volume_mm3"], 6, places=5)

    def test_selection_and_names(self):
        everything = {label["value"]: label["voxels"] for label in self.info("phantom:abdomen@48")["labels"]}
        first, second, third, *_ = sorted(everything)
        (self.folder / "names.txt").write_text(f"{third} the third one\n")
        chosen = self.info("phantom:abdomen@48", "--merge", f"{first},{second}=pair", "--labels",
                           f"{first}-{third}", "--label-names", self.folder / "names.txt")
        by_value = {label["value"]: label for label in chosen["labels"]}
        self.assertEqual(set(by_value), {first, third})
        self.assertEqual(by_value[first]["name"], "pair")
        self.assertEqual(by_value[first]["voxels"], everything[first] + everything[second])
        dropped = self.info("phantom:abdomen@48", "--drop", str(second))
        self.assertEqual({label["value"] for label in dropped["labels"]}, set(everything) - {second})

    def test_text_has_the_same(self):
        info = self.info("phantom:spheres@24")
        process = run_podm("info", "phantom:spheres@24")
        self.assert_exit(process, 0)
        rows = [line.split() for line in process.stdout.splitlines()]
        for label in info["labels"]:
            self.assertTrue(any(row[:2] == [str(label["value"]), str(label["voxels"])] for row in rows))
        self.assertEqual(process.stderr, "")


    def test_an_image_without_background_says_so(self):
        path = self.folder / "full.nii"
        for voxels, is_full in (bytes([3, 4] * 864), True), (bytes([0, 4] * 864), False):
            small_images.write_nifti(path, voxels)
            process = run_podm("info", path)
            self.assert_exit(process, 0)
            self.assertEqual("no background" in process.stdout, is_full, process.stdout)
        small_images.write_nifti(path, bytes([3, 4] * 864))
        self.assertNotIn("no background", run_podm("info", path, "--background", "3").stdout)

    def test_a_meta_image_with_an_old_stream_size_in_its_header_is_read_with_a_warning(self):
        path = self.folder / "stale.mha"
        voxels = small_images.ball_voxels(12)
        small_images.write_metaimage(path, voxels, compressed_size=7)
        process = run_podm("info", "--json", path)
        self.assert_exit(process, 0)
        info = json.loads(process.stdout)
        self.assertEqual(info["labels"][0]["voxels"], sum(voxels))
        self.assertEqual(len(info["warnings"]), 1)
        self.assertIn("stale.mha: CompressedDataSize is 7", process.stderr)
        self.assertEqual(self.info("phantom:spheres@24")["warnings"], [])
        runs = self.folder / "runs.jsonl"
        process = run_podm("mesh", path, "-o", self.folder / "out.mesh", "--verify", "--record", runs)
        self.assert_exit(process, 0)
        self.assertIn("CompressedDataSize is 7", process.stderr)
        self.assertIn(info["warnings"][0], self.read_record(runs)["warnings"])
        path.write_bytes(path.read_bytes()[:-4])
        self.assert_refused(["info", path], "stale.mha", "truncated")


class Phantom(PodmTestCase):
    def test_names_of_labels_are_those_of_the_phantom(self):
        for phantom in "abdomen", "spheres", "torus":
            path, names = self.folder / "p.nii", self.folder / "names.txt"
            self.assert_exit(run_podm("phantom", phantom, "--size", "64", "-o", path, "--label-names", names), 0)
            from_file, direct = (json.loads(run_podm("info", "--json", *image).stdout)["labels"]
                                 for image in ((path, "--label-names", names), (f"phantom:{phantom}@64",)))
            self.assertEqual(from_file, direct)
            self.assertTrue(all(label["name"] for label in from_file))

    def test_names_without_an_image_are_not_left_behind(self):
        names = self.folder / "names.txt"
        self.assert_refused(["phantom", "torus", "--label-names", names, "-o", self.folder / "p.png"], "p.png")
        self.assert_refused(["phantom", "torus", "--label-names", names, "-o", names], "is the file of the image")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_written_phantom_is_the_phantom(self):
        path = self.folder / "p.nii.gz"
        self.assert_exit(run_podm("phantom", "torus", "--size", "32", "-o", path), 0)
        from_file, direct = (json.loads(run_podm("info", "--json", image).stdout)
                             for image in (path, "phantom:torus@32"))
        for key in ("size", "background"):
            self.assertEqual(from_file[key], direct[key])
        key = lambda info: [(label["value"], label["voxels"]) for label in info["labels"]]
        self.assertEqual(key(from_file), key(direct))
        for row, other in zip(from_file["affine"], direct["affine"]):
            for x, y in zip(row, other):
                self.assertAlmostEqual(x, y, places=3)


if __name__ == "__main__":
    unittest.main()
