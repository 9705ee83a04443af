"""podm mesh --algorithm pdr, pdr-podm: leaf by leaf, with the schedule that podm-verify checks."""

import json
import os
import unittest

from podm_process import PROGRAM, PodmTestCase, run_podm
from slow import few

VERIFIER = os.path.join(os.path.dirname(PROGRAM), "podm-verify")
IMAGE = "phantom:abdomen@40"


class Leaves(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out.vtu"
        self.schedule = self.folder / "leaves.jsonl"
        self.log = self.folder / "run.log"
        self.runs = self.folder / "runs.jsonl"

    def mesh(self, *arguments):
        process = run_podm("mesh", IMAGE, "--radius", "14", "-o", self.out, "--record", self.runs, "--oversubscribe",
                           "--schedule", self.schedule, "--log", self.log, *arguments)
        self.assert_exit(process, 0)
        return json.loads(self.runs.read_text().splitlines()[-1])

    def test_meshes_and_schedules_verify_and_runs_equal_their_replay(self):
        for arguments in few((
                ["--algorithm", "pdr-podm", "--nodes", 2, "--cores-per-node", 2, "--space", "LPS"],
                ["--algorithm", "pdr", "--threads", 2, "--radius-of", "liver=5"],
                ["--algorithm", "pdr-podm", "--executor", "virtual", "--nodes", 16, "--cores-per-node", 4],
                ["--algorithm", "pdr"], ["--algorithm", "pdr", "--threads", 5],
                ["--algorithm", "pdr-podm", "--nodes", 3, "--threads", 3, "--pin", "none"],
                ["--algorithm", "pdr", "--executor", "virtual", "--threads", 16]), 3):
            with self.subTest(arguments=arguments):
                record = self.mesh("--verify", *arguments)
                self.assertEqual(set(record["verdicts"].values()), {"pass"})
                self.assertGreater(record["leaves"]["number"], 10)
                self.assertLessEqual({"allocate", "initial", "octree", "refine", "closing"}, set(record["phases_s"]))
                if record["virtual"]:
                    phases = record["virtual"]["phases_s"]
                    self.assertEqual(set(phases), {"read", "transform", "allocate", "initial", "octree", "refine",
                                                   "closing", "extract"})
                    refining = phases["initial"] + phases["refine"] + phases["closing"]
                    self.assertAlmostEqual(refining, record["virtual"]["refine_s"], places=12)
                self.assert_schedule_passes()
                self.assert_exit(run_podm("replay", IMAGE, self.log), 0)

    def assert_schedule_passes(self):
        report = self.folder / "report.json"
        process = run_podm(self.out, "--schedule", self.schedule, "--json", report, program=VERIFIER)
        self.assert_exit(process, 0)
        self.assertEqual(json.loads(report.read_text())["claims"]["conformity"]["verdict"], "pass")

    def test_schedules_follow_the_space_of_the_mesh(self):
        for space in "RAS", "LPS", "voxel":
            self.mesh("--algorithm", "pdr", "--threads", 2, "--space", space)
            process = run_podm(self.out, "--claims", "conformity", "--schedule", self.schedule, program=VERIFIER)
            self.assert_exit(process, 0)

    def test_a_schedule_of_leaves_too_near_to_each_other_fails(self):
        self.mesh("--algorithm", "pdr", "--threads", 2)
        lines = self.schedule.read_text().splitlines()
        whole_run = json.loads(lines[1]) | {"begin_s": 0, "end_s": 1e9}
        self.schedule.write_text("\n".join([lines[0], json.dumps(whole_run), *lines[2:]]) + "\n")
        self.assert_exit(run_podm(self.out, "--schedule", self.schedule, program=VERIFIER), 1)

    def test_virtual_runs_are_the_same_for_the_same_seed(self):
        runs = [self.mesh("--algorithm", "pdr-podm", "--executor", "virtual", "--nodes", 4, "--cores-per-node", 4,
                          "--seed", 3) for _ in range(2)]
        for name in "mesh_sha256", "outcomes", "virtual", "counters":
            self.assertEqual(runs[0][name], runs[1][name], name)

    def test_options_that_do_not_go_together_are_refused(self):
        for arguments, word in ((["--algorithm", "pdr", "--cores-per-node", "2"], "pdr"),
                                (["--algorithm", "pdr-podm", "--nodes", "3", "--threads", "4"], "divide"),
                                (["--algorithm", "pdr-podm", "--nodes", "2", "--cores-per-node", "3", "--threads", "4"],
                                 "threads"),
                                (["--algorithm", "pdr", "--initial-ratio", "0.5"], "ratio"),
                                (["--algorithm", "pdr", "--initial-threads", "9"], "initial"),
                                (["--algorithm", "pdr", "--leaf-size", "-1"], "--leaf-size"),
                                (["--algorithm", "pdr", "--leaf-size", "0.5"], "leaf size of 0.5 mm gives"),
                                (["--schedule", self.schedule], "podm has no leaves"),
                                (["--algorithm", "podm-home", "--schedule", self.schedule], "podm-home has no leaves"),
                                (["--algorithm", "auto", "--schedule", self.schedule], "auto has no leaves"),
                                (["--algorithm", "tree"], "pdr-podm")):
            with self.subTest(arguments=arguments):
                self.assert_refused(["mesh", IMAGE, "--oversubscribe", "-o", self.out, *arguments], word)


if __name__ == "__main__":
    unittest.main()
