"""Constants of virtual time multiplied by a factor, and the hash of the model in records."""

import json
import os
import unittest

from podm_process import PodmTestCase, run_podm

BLACKLIGHT = os.path.join(os.path.dirname(__file__), "../../experiments/machines/blacklight.toml")


class CostFactor(PodmTestCase):
    def run_with(self, *arguments):
        return run_podm("mesh", "phantom:abdomen@24", "--radius", 20, "-o", self.folder / "out.vtu", "--record",
                        self.folder / "runs.jsonl", "--threads", 32, "--pin", "compact", *arguments)

    def record(self, *arguments):
        self.assert_exit(self.run_with("--executor", "virtual", "--topology", BLACKLIGHT, *arguments), 0)
        return json.loads((self.folder / "runs.jsonl").read_text().splitlines()[-1])

    def test_the_model_has_one_hash_whatever_runs(self):
        hashes = {self.record(*arguments)["virtual"]["model_sha256"]
                  for arguments in ([], ["--algorithm", "podm-home"], ["--seed", 2])}
        self.assertEqual(len(hashes), 1)
        self.assertRegex(hashes.pop(), "^[0-9a-f]{64}$")

    def test_a_factor_of_one_changes_nothing_but_the_hash(self):
        plain, same = self.record(), self.record("--cost-factor", "classified=1")
        self.assertNotEqual(plain["virtual"]["model_sha256"], same["virtual"]["model_sha256"])
        self.assertEqual(plain["mesh_sha256"], same["mesh_sha256"])
        self.assertEqual(plain["virtual"]["worker_s"], same["virtual"]["worker_s"])

    def test_constants_that_are_off_cost_nothing(self):
        plain = self.record()["virtual"]
        for name, what, phase in (("cell_extracted", "phases_s", "extract"),
                                  ("voxel_transformed", "phases_s", "transform"),
                                  ("hop_latency", "worker_s", "memory_remote")):
            with self.subTest(name=name):
                self.assertGreater(plain[what][phase], 0)
                self.assertEqual(self.record("--cost-factor", f"{name}=0")["virtual"][what][phase], 0)
                if what == "phases_s":
                    doubled = self.record("--cost-factor", f"{name}=2")["virtual"][what][phase]
                    self.assertAlmostEqual(doubled, 2 * plain[what][phase], places=15)

    def test_shared_lines_and_new_pages_cost_nothing_unless_asked_for(self):
        plain = self.record()["virtual"]["worker_s"]
        for name in ("line_transfer", "page_fault"):
            with self.subTest(name=name):
                self.assertEqual(self.record("--cost-factor", f"{name}=0")["virtual"]["worker_s"], plain)
                more = self.record("--cost-factor", f"{name}=8")["virtual"]["worker_s"]
                self.assertGreater(more["locks"] + more["between_attempts"], plain["locks"] + plain["between_attempts"])

    def test_what_has_no_constants_is_refused(self):
        for arguments in (["--executor", "virtual"], ["--topology", BLACKLIGHT]):
            process = self.run_with("--cost-factor", "wake=2", "--oversubscribe", *arguments)
            self.assert_exit(process, 2)
            self.assertIn("--cost-factor requires", process.stderr)
        process = self.run_with("--executor", "virtual", "--topology", BLACKLIGHT, "--cost-factor", "speed=2")
        self.assert_exit(process, 2)
        self.assertIn("unknown constant 'speed'", process.stderr)


if __name__ == "__main__":
    unittest.main()
