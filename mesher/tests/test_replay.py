"""podm mesh --log and podm replay: a run of many workers equals the serial run of its operations."""

import json
import pathlib
import unittest

from podm_process import PodmTestCase, run_podm

IMAGE = "phantom:abdomen@40"
BLACKLIGHT = pathlib.Path(__file__).resolve().parents[2] / "experiments/machines/blacklight.toml"


class Replay(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out.mesh"
        self.log = self.folder / "run.log"
        self.runs = self.folder / "runs.jsonl"

    def mesh(self, *arguments):
        process = run_podm("mesh", IMAGE, "--radius", "16", "-o", self.out, "--log", self.log, "--record", self.runs,
                           "--oversubscribe", *arguments)
        self.assert_exit(process, 0)
        return json.loads(self.runs.read_text().splitlines()[-1])

    def test_every_run_equals_its_replay(self):
        for arguments in ([], ["--threads", 2], ["--threads", 9, "--contention", "global"],
                          ["--executor", "virtual", "--threads", 64, "--seed", 5],
                          ["--executor", "virtual", "--threads", 3, "--contention", "aggressive"],
                          # The initial mesh moves to the nodes of its leaves.
                          ["--algorithm", "pdr-podm", "--threads", 32, "--cores-per-node", 16, "--pin", "compact",
                           "--topology", BLACKLIGHT, "--executor", "virtual"],
                          # A leaf of this size has a corner of the virtual box, which is never moved.
                          ["--algorithm", "pdr-podm", "--threads", 64, "--cores-per-node", 16, "--pin", "compact",
                           "--topology", BLACKLIGHT, "--executor", "virtual", "--leaf-size", 425],
                          ["--algorithm", "pdr", "--threads", 4, "--pin", "scatter", "--topology", BLACKLIGHT],
                          ["--threads", 3, "--min-dihedral", 8],
                          ["--executor", "virtual", "--threads", 64, "--min-dihedral", 12],
                          ["--algorithm", "pdr-podm", "--threads", 6, "--nodes", 3, "--min-dihedral", 8],
                          ["--threads", 3, "--space", "voxel"], ["--threads", 2, "--labels", "2-5", "--space", "LPS"]):
            with self.subTest(arguments=arguments):
                record = self.mesh(*arguments)
                labels = ["--labels", "2-5"] if "--labels" in arguments else []
                process = run_podm("replay", IMAGE, self.log, *labels)
                self.assert_exit(process, 0)
                self.assertEqual(process.stdout, "")
                self.assertEqual(process.stderr.count(record["mesh_sha256"]), 2)

    def test_a_run_cut_short_equals_its_replay(self):
        process = run_podm("mesh", IMAGE, "--radius", "4", "--threads", 3, "--oversubscribe", "--max-elements", 3000,
                           "-o", self.out, "--log", self.log)
        self.assert_exit(process, 1)
        self.assert_exit(run_podm("replay", IMAGE, self.log), 0)

    def test_a_search_for_the_radius_logs_its_last_run_only(self):
        process = run_podm("mesh", IMAGE, "--target-elements", 20000, "--threads", 2, "--oversubscribe",
                           "-o", self.out, "--log", self.log)
        self.assert_exit(process, 0)
        self.assert_exit(run_podm("replay", IMAGE, self.log), 0)

    def test_virtual_runs_depend_on_nothing_but_the_seed(self):
        def run(seed, threads=256):
            return self.mesh("--executor", "virtual", "--threads", threads, "--seed", seed)
        first, second, other = run(7), run(7), run(8)
        for name in "mesh_sha256", "outcomes", "overhead_s", "virtual", "counters":
            self.assertEqual(first[name], second[name], name)
        self.assertNotEqual(first["mesh_sha256"], other["mesh_sha256"])
        self.assertGreater(first["virtual"]["refine_s"], 0)
        self.assertGreater(run(7, threads=1)["virtual"]["refine_s"],
                           2 * first["virtual"]["refine_s"])

    def test_a_log_that_was_changed_is_refused_or_not_equal(self):
        self.mesh()
        sound = self.log.read_bytes()
        operation = 16 + 48 * 1000  # after the magic and the counts of the first batch
        for offset in range(8, 44, 5):  # bytes of its point, vertex, worker and kind
            at = operation + offset
            self.log.write_bytes(sound[:at] + bytes([sound[at] ^ 0x21]) + sound[at + 1:])
            process = run_podm("replay", IMAGE, self.log)
            where_to_search_only = 36 <= offset < 40
            self.assertIn(process.returncode, (0,) if where_to_search_only else (1, 2), (offset, process.stderr))
            if process.returncode == 2:
                self.assertRegex(process.stderr, "run.log.*operation")
        self.log.write_bytes(sound.replace(b'"mesh_sha256":"', b'"mesh_sha256":"0', 1))
        self.assert_exit(run_podm("replay", IMAGE, self.log), 1)

    def test_logs_of_other_images_and_broken_logs_are_refused(self):
        self.mesh()
        self.assert_refused(["replay", "phantom:abdomen@41", self.log], "run.log", "phantom:abdomen@41")
        self.assert_refused(["replay", IMAGE, self.log, "--drop", "3"], "run.log")
        self.assert_refused(["replay", IMAGE, self.folder / "none.log"], "none.log")
        self.assert_refused(["replay", IMAGE, self.out], "out.mesh", "not a linearization log")
        self.log.write_bytes(self.log.read_bytes()[:1000])
        self.assert_refused(["replay", IMAGE, self.log], "run.log", "ends within")

    def test_a_log_that_cannot_be_written_is_refused_before_meshing(self):
        self.assert_refused(["mesh", IMAGE, "-o", self.out, "--log", self.folder / "none" / "run.log"], "run.log")


if __name__ == "__main__":
    unittest.main()
