"""podm mesh --crossover N: the algorithm of pdr-podm and auto on fewer and on more threads."""

import json
import os
import unittest

from podm_process import PodmTestCase, run_podm

IMAGE = "phantom:abdomen@40"
BLACKLIGHT = os.path.join(os.path.dirname(__file__), "../../experiments/machines/blacklight.toml")


class Crossover(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out.vtu"

    def mesh(self, *arguments):
        """Returns the record of a run."""
        runs = self.folder / "runs.jsonl"
        process = run_podm("mesh", IMAGE, "--radius", 20, "--oversubscribe", "-o", self.out, "--record", runs,
                           *arguments)
        self.assert_exit(process, 0)
        return json.loads(runs.read_text().splitlines()[-1])

    def test_auto_is_podm_below_the_crossover_and_podm_home_from_it_on(self):
        for threads, algorithm in (2, "podm"), (3, "podm-home"):
            record = self.mesh("--algorithm", "auto", "--threads", threads, "--crossover", 3)
            self.assertEqual(record["algorithm"], algorithm)
            self.assertEqual(record["options"]["crossover"], 3)

    def test_pdr_podm_is_exactly_podm_below_the_crossover(self):
        virtual = ("--executor", "virtual", "--seed", 7, "--topology", BLACKLIGHT)
        podm = self.mesh("--algorithm", "podm", "--threads", 31, *virtual)
        below = self.mesh("--algorithm", "pdr-podm", "--threads", 31, "--crossover", 32, *virtual)
        for key in "algorithm", "mesh_sha256", "virtual", "counters":
            self.assertEqual(below[key], podm[key], key)

    def test_pdr_podm_is_itself_from_the_crossover_on(self):
        virtual = ("--executor", "virtual", "--seed", 7, "--topology", BLACKLIGHT, "--algorithm", "pdr-podm")
        free = self.mesh("--threads", 32, *virtual)
        for crossover in 1, 32:
            above = self.mesh("--threads", 32, "--crossover", crossover, *virtual)
            for key in "algorithm", "mesh_sha256", "virtual", "leaves":
                self.assertEqual(above[key], free[key], key)

    def test_auto_without_a_crossover_is_podm_home_on_several_numa_nodes(self):
        for threads, pin, algorithm in ((16, "compact", "podm"), (17, "compact", "podm"), (32, "none", "podm"),
                                        (32, "compact", "podm-home")):
            record = self.mesh("--algorithm", "auto", "--executor", "virtual", "--topology", BLACKLIGHT, "--pin", pin,
                               "--threads", threads)
            self.assertEqual(record["algorithm"], algorithm)

    def test_senseless_crossovers_are_refused(self):
        for number in "0", "-1", "1025", "99999999999999999999", "crossover.json":
            self.assert_refused(["mesh", IMAGE, "-o", self.out, "--algorithm", "auto", "--crossover", number],
                                "--crossover", number)
        for algorithm in "podm", "pdr", "podm-home":
            self.assert_refused(["mesh", IMAGE, "-o", self.out, "--algorithm", algorithm, "--crossover", 4],
                                "crossover", algorithm)
        self.assert_refused(["mesh", IMAGE, "-o", self.out, "--algorithm", "pdr-podm", "--crossover", 4,
                             "--schedule", self.folder / "leaves.jsonl"], "schedule", "crossover")


if __name__ == "__main__":
    unittest.main()
