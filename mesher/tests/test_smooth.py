"""podm mesh --smooth: interfaces where blurred labels tie. podm-verify proves them; record, file and summary list the
width."""

import json
import os
import subprocess
import unittest

from podm_process import PROGRAM, PodmTestCase, run_podm
from slow import few

VERIFIER = os.path.join(os.path.dirname(PROGRAM), "podm-verify")
IMAGE = "phantom:abdomen@48"
SIZES = ("--radius", 9)


class Smooth(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.runs = self.folder / "runs.jsonl"

    def mesh(self, *arguments, name="out.vtu", image=IMAGE):
        return run_podm("mesh", image, "-o", self.folder / name, "--record", self.runs, *SIZES, *arguments)

    def record_of(self, *arguments, **more):
        self.runs.unlink(missing_ok=True)
        self.assert_exit(self.mesh(*arguments, **more), 0)
        return self.read_record(self.runs)

    def voxel_mm(self):
        spacing = json.loads(run_podm("info", IMAGE, "--json").stdout)["spacing_mm"]
        return (spacing[0] * spacing[1] * spacing[2]) ** (1 / 3)

    def test_every_algorithm_keeps_all_claims_and_equals_its_replay(self):
        image = self.folder / "image.nii.gz"
        self.assert_exit(run_podm("phantom", "abdomen", "--size", 48, "-o", image), 0)
        for algorithm in few((["pdr-podm", "--nodes", 2, "--cores-per-node", 1], ["podm", "--threads", 2],
                              ["podm-home", "--nodes", 2]), 1):
            log = self.folder / "run.log"
            record = self.record_of("--smooth", 1.5 * self.voxel_mm(), "--algorithm", *algorithm, "--oversubscribe",
                                    "--log", log, "--verify-fidelity", image=image)
            self.assertEqual(set(record["verdicts"].values()), {"pass"}, algorithm)
            self.assertIn("fidelity", record["verdicts"])
            self.assertEqual(set(record["guarantees"].values()), {0})
            self.assert_exit(run_podm("replay", image, log), 0)

    def test_the_record_has_volumes_of_voxels_and_smoothed_ones_that_are_the_meshs(self):
        record = self.record_of("--smooth", 1.5 * self.voxel_mm(), "--delta", 0.7 * self.voxel_mm())
        smoothing = record["smoothing"]
        self.assertEqual(record["options"]["smoothing_mm"], smoothing["width_mm"])
        self.assertIn("smooth", record["phases_s"])
        meshed = {label["value"]: label["volume_mm3"] for label in record["labels"]}
        stairs = self.record_of("--smooth", 0.4 * self.voxel_mm())["smoothing"]["labels"]  # narrower than a voxel
        for label, of_stairs in zip(smoothing["labels"], stairs, strict=True):
            self.assertEqual(label["voxels_mm3"], of_stairs["voxels_mm3"])
            self.assertEqual(label["voxels_components"], of_stairs["voxels_components"])
            self.assertIn(label["smoothed_components"], range(1, label["voxels_components"] + 1))
            if label["voxels_mm3"] > 500 * self.voxel_mm() ** 3:
                self.assertAlmostEqual(label["smoothed_mm3"] / of_stairs["smoothed_mm3"], 1, delta=0.03)
        whole = sum(label["smoothed_mm3"] for label in smoothing["labels"])
        self.assertAlmostEqual(sum(meshed.values()) / whole, 1, delta=0.02)
        self.assertIsNone(self.record_of()["smoothing"])

    def test_a_blur_below_half_a_voxel_is_said_to_smooth_nothing(self):
        for voxels, is_reported in ((0.45, True), (0.55, False)):
            self.assertEqual("smooths nothing" in self.mesh("--smooth", voxels * self.voxel_mm()).stderr, is_reported)

    def test_the_summary_has_them_too(self):
        process = self.mesh("--smooth", 1.5 * self.voxel_mm())
        self.assertIn("smoothed ", process.stderr)
        self.assertNotIn("smoothed ", self.mesh().stderr)

    def test_files_say_so_and_keep_the_word_when_they_are_converted(self):
        image, width = self.folder / "image.nii.gz", 2 * self.voxel_mm()
        self.assert_exit(run_podm("phantom", "abdomen", "--size", 48, "-o", image), 0)
        self.record_of("--smooth", width)
        for name in "out.vtu", "out.vtk", "out.mesh", "out.msh":
            if name != "out.vtu":
                self.assert_exit(run_podm("convert", self.folder / "out.vtu", self.folder / name), 0)
            labels = self.verdict_on_labels(name, image)
            self.assertEqual(labels["verdict"], "pass", name)
        self.record_of()  # not smoothed: the image's stairs are another surface
        self.assertEqual(self.verdict_on_labels("out.vtu", image)["verdict"], "pass")
        self.assertEqual(self.verdict_on_labels("out.vtu", image, "--smooth", width)["verdict"], "fail")

    def verdict_on_labels(self, name, image, *options):
        report = self.folder / "report.json"
        subprocess.run([VERIFIER, self.folder / name, "--image", image, "--claims", "labels", "--json", report,
                        *map(str, options)], capture_output=True, text=True, check=False)
        return json.loads(report.read_text())["claims"]["labels"]

    def test_a_label_that_the_width_would_lose_is_reported_and_kept(self):
        image = self.folder / "thin.nrrd"
        size = 24
        voxels = bytes(2 if k == 12 and 4 <= i < 20 and 4 <= j < 20 else 1 if all(4 <= x < 20 for x in (i, j, k)) else 0
                       for k in range(size) for j in range(size) for i in range(size))
        image.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 24 24 24\nencoding: raw\n\n" + voxels)
        process = run_podm("mesh", image, "--smooth", 2, "--delta", 0.7, "-o", self.folder / "out.vtu", "--verify")
        self.assert_exit(process, 0)
        self.assertIn("warning: label 2 (256 mm^3) is thin", process.stderr)

    def test_widths_that_make_no_sense_are_refused_and_nothing_is_written(self):
        for width in -1, 0, "nan", 1e9, "wide":
            process = self.mesh("--smooth", width)
            self.assert_exit(process, 2)
            self.assertRegex(process.stderr, "smooth|blur")
            self.assertEqual(list(self.folder.glob("out*")), [])
        process = self.mesh("--smooth", 300)
        self.assert_exit(process, 2)
        for words in ("300 mm", "shortest side"):
            self.assertIn(words, process.stderr)


if __name__ == "__main__":
    unittest.main()
