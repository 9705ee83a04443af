"""podm mesh within --max-memory-gib, where the estimate has let a run begin that its limit ends."""

import unittest

import small_images
from podm_process import PodmTestCase, run_podm

GIB = 2 ** 30
# Interfaces alone take more cells than this target, which the estimate believes.
TOO_FEW = ["--target-elements", 1000, "--delta", 0.05]
ALGORITHMS = (["podm", "--threads", 1], ["podm", "--threads", 2], ["pdr", "--threads", 2],
              ["pdr-podm", "--threads", 4, "--nodes", 2], ["pdr", "--threads", 16, "--executor", "virtual"])


class MemoryLimit(PodmTestCase):
    def test_the_process_stays_within_and_writes_a_valid_mesh(self):
        image = small_images.write_nifti(self.folder / "ball.nii", small_images.ball_voxels(40), (40, 40, 40))
        for gib in (0.05, 0.07, 0.1):
            for algorithm, *options in ALGORITHMS:
                with self.subTest(gib=gib, algorithm=algorithm, options=options):
                    self.check(image, gib, ["--algorithm", algorithm, *options, "--oversubscribe"])

    def check(self, image, gib, options):
        mesh, record = self.folder / "out.vtu", self.folder / "record.jsonl"
        record.unlink(missing_ok=True)
        process = run_podm("mesh", image, *TOO_FEW, "--max-memory-gib", gib, *options, "-o", mesh, "--record", record,
                           "--quiet", *(["--verify"] if gib < 0.06 else []))
        self.assert_exit(process, 1)
        self.assertIn("memory limit", process.stderr)
        told = self.read_record(record)
        self.assertEqual(told["stop_reason"], "memory limit")
        if told["verdicts"]:
            self.assertEqual([told["verdicts"][claim] for claim in ("structure", "delaunay")], ["pass", "pass"])
        self.assertLessEqual(told["peak_rss_bytes"] / GIB / gib, 1)
        self.assertGreater(told["peak_rss_bytes"] / GIB / gib, 0.5, "what is granted is used")

    def test_many_workers_leave_little_of_the_store_unused(self):
        image = small_images.write_nifti(self.folder / "ball.nii", small_images.ball_voxels(40), (40, 40, 40))
        record = self.folder / "record.jsonl"
        process = run_podm("mesh", image, *TOO_FEW, "--max-memory-gib", 0.2, "--executor", "virtual", "--threads", 512,
                           "-o", self.folder / "out.vtu", "--record", record, "--quiet")
        self.assert_exit(process, 1)
        told = self.read_record(record)
        self.assertEqual(told["stop_reason"], "memory limit")
        self.assertGreater(told["cells"], 150_000)
        self.assertLessEqual(told["peak_rss_bytes"] / GIB / 0.2, 1)

    def test_a_limit_that_the_image_itself_takes_is_refused(self):
        image = small_images.write_nifti(self.folder / "ball.nii", small_images.ball_voxels(40), (40, 40, 40))
        self.assert_refused(["mesh", image, *TOO_FEW, "--max-memory-gib", 0.01, "-o", self.folder / "out.vtu"],
                            image, "GiB", "no room")

    def test_more_cells_than_can_be_numbered_are_refused_before(self):
        image = small_images.write_nifti(self.folder / "ball.nii", small_images.ball_voxels(40), (40, 40, 40))
        self.assert_refused(["mesh", image, "--radius", 0.01, "--max-memory-gib", 1e6, "-o", self.folder / "out.vtu"],
                            image, "2^30")


if __name__ == "__main__":
    unittest.main()
