"""podm mesh with --max-memory-gib, when the estimate lets a run begin that the limit then ends."""

import array
import os
import unittest

import small_images
from podm_process import PodmTestCase, run_podm
from slow import few

GIB = 2 ** 30
# Interfaces alone take more cells than this target, but the estimate relies on the target.
TOO_FEW = ["--target-elements", 1000, "--delta", 0.05]
ALGORITHMS = (["podm", "--threads", 1], ["podm", "--threads", 2], ["pdr", "--threads", 2],
              ["pdr-podm", "--threads", 4, "--nodes", 2], ["pdr", "--threads", 16, "--executor", "virtual"])
# Values below the estimate, so that the run begins.
LEAVES = ["--radius", 0.35, "--delta", 0.3, "--max-elements", 1_300_000, "--initial-ratio", 4, "--threads", 2,
          "--oversubscribe", "--leaf-size"]


class MemoryLimit(PodmTestCase):
    def test_the_process_stays_within_and_writes_a_valid_mesh(self):
        image = small_images.write_nifti(self.folder / "ball.nii", small_images.ball_voxels(40), (40, 40, 40))
        for gib in few((0.05, 0.07, 0.1), 1):
            for algorithm, *options in ALGORITHMS:
                with self.subTest(gib=gib, algorithm=algorithm, options=options):
                    self.check(image, gib, ["--algorithm", algorithm, *options, "--oversubscribe"])

    def full_image(self, size, **options):
        """Returns an image of label 1 everywhere, as numbers 1 of an array type."""
        voxels = array.array(options.pop("type", "B"), [1]) * size ** 3
        return small_images.write_nifti(self.folder / "full.nii", voxels.tobytes(), (size,) * 3, **options)

    def check(self, image, gib, options, mesh_options=TOO_FEW, **popen_options):
        mesh, record = self.folder / "out.vtu", self.folder / "record.jsonl"
        record.unlink(missing_ok=True)
        process = run_podm("mesh", image, *mesh_options, "--max-memory-gib", gib, *options, "-o", mesh, "--record",
                           record, "--quiet", *(["--verify"] if gib < 0.06 else []), **popen_options)
        self.assert_exit(process, 1)
        self.assertIn("memory limit", process.stderr)
        run = self.read_record(record)
        self.assertEqual(run["stop_reason"], "memory limit")
        if run["verdicts"]:
            self.assertEqual([run["verdicts"][claim] for claim in ("structure", "delaunay")], ["pass", "pass"])
        self.assertLessEqual(run["peak_rss_bytes"] / GIB / gib, 1)
        self.assertGreater(run["peak_rss_bytes"] / GIB / gib, 0.5, "what is granted is used")

    def test_many_workers_leave_little_of_the_store_unused(self):
        image = small_images.write_nifti(self.folder / "ball.nii", small_images.ball_voxels(40), (40, 40, 40))
        record = self.folder / "record.jsonl"
        process = run_podm("mesh", image, *TOO_FEW, "--max-memory-gib", 0.2, "--executor", "virtual", "--threads", 512,
                           "-o", self.folder / "out.vtu", "--record", record, "--quiet")
        self.assert_exit(process, 1)
        run = self.read_record(record)
        self.assertEqual(run["stop_reason"], "memory limit")
        self.assertGreater(run["cells"], 150_000)
        self.assertLessEqual(run["peak_rss_bytes"] / GIB / 0.2, 1)

    # Each thread has an arena of the allocator on machines with many processors.
    def test_threads_are_charged_with_what_they_take(self):
        image = small_images.write_nifti(self.folder / "ball.nii", small_images.ball_voxels(40), (40, 40, 40))
        arenas = {**os.environ, "GLIBC_TUNABLES": "glibc.malloc.arena_max=1000"}
        for gib, threads, environment in few(((0.08, 64, arenas), (0.07, 16, None), (0.2, 224, None)), 1):
            for algorithm in "podm", "pdr":
                with self.subTest(gib=gib, threads=threads, algorithm=algorithm, environment=environment is not None):
                    self.check(image, gib, ["--threads", threads, "--algorithm", algorithm, "--oversubscribe"],
                               env=environment)

    def test_leaves_have_a_share_of_the_limit(self):
        image = self.full_image(24)
        for algorithm, gib, leaf_mm in ("pdr", 0.1, 0.29), ("pdr", 0.25, 0.29), ("pdr-podm", 0.06, 0.4):
            with self.subTest(algorithm=algorithm, gib=gib, leaf_mm=leaf_mm):
                self.assert_refused(["mesh", image, *LEAVES, leaf_mm, "--algorithm", algorithm, "--max-memory-gib", gib,
                                     "-o", self.folder / "out.vtu"], f"{leaf_mm} mm", "memory limit", "GiB")
        for algorithm in "pdr", "pdr-podm":
            with self.subTest(algorithm=algorithm):
                self.check(image, 0.12, ["--algorithm", algorithm], [*LEAVES, 0.5])

    # Each voxel takes eight bytes in the file, and two for its label.
    def test_an_image_that_cannot_be_read_within_the_limit_is_refused_before(self):
        image = self.full_image(180, type="d", datatype=small_images.FLOAT64)
        options = ["--target-elements", 1000, "--delta", 0.2]
        for gib in 0.055, 0.065:
            self.assert_refused(["mesh", image, *options, "--max-memory-gib", gib, "-o", self.folder / "out.vtu"],
                                image, "during reading", "room for only", "GiB")
        self.check(image, 0.08, [], options)

    def test_readers_of_all_formats_look_at_the_limit_before_they_read(self):
        size, voxels = 120, bytes([1]) * 120 ** 3
        inr = b"#INRIMAGE-4#{\nXDIM=120\nYDIM=120\nZDIM=120\nVDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\nCPU=pc\n"
        nrrd = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 120 120 120\nencoding: raw\n\n"
        (self.folder / "a.inr").write_bytes(inr.ljust(252, b"\n") + b"##}\n" + voxels)
        (self.folder / "a.nrrd").write_bytes(nrrd + voxels)
        small_images.write_metaimage(self.folder / "a.mha", voxels, size)
        small_images.write_metaimage(self.folder / "zipped.mha", voxels, size, compressed_size=0)
        small_images.write_nifti(self.folder / "a.nii", voxels, (size,) * 3)
        for name in "a.inr", "a.nrrd", "a.mha", "zipped.mha", "a.nii":
            with self.subTest(name=name):
                self.assert_refused(["mesh", self.folder / name, *TOO_FEW, "--max-memory-gib", 0.018,
                                     "-o", self.folder / "out.vtu"], name, "during reading")

    def test_a_limit_that_the_image_itself_takes_is_refused(self):
        image = small_images.write_nifti(self.folder / "ball.nii", small_images.ball_voxels(40), (40, 40, 40))
        self.assert_refused(["mesh", image, *TOO_FEW, "--max-memory-gib", 0.01, "-o", self.folder / "out.vtu"],
                            image, "GiB", "room for only")

    def test_more_cells_than_can_be_numbered_are_refused_before(self):
        image = small_images.write_nifti(self.folder / "ball.nii", small_images.ball_voxels(40), (40, 40, 40))
        for options in (["--radius", 0.01], ["--radius", 0.02, "--max-elements", 1_100_000_000],
                        ["--target-elements", 1_000_000_000]):  # background cells are additional
            with self.subTest(options=options):
                self.assert_refused(["mesh", image, *options, "--max-memory-gib", 1e6, "-o", self.folder / "out.vtu"],
                                    image, "2^30")


if __name__ == "__main__":
    unittest.main()
