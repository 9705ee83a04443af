"""podm mesh --algorithm podm-home: computing nodes that stay in their own blocks of space."""

import json
import os
import unittest

from podm_process import PodmTestCase, run_podm
from slow import few

IMAGE = "phantom:abdomen@40"
BLACKLIGHT = os.path.join(os.path.dirname(__file__), "../../experiments/machines/blacklight.toml")
ON_BLADES = "--executor", "virtual", "--topology", BLACKLIGHT, "--pin", "compact", "--threads", 64


class Home(PodmTestCase):
    def mesh(self, algorithm, *arguments):
        runs, self.log = self.folder / "runs.jsonl", self.folder / "run.log"
        process = run_podm("mesh", IMAGE, "--radius", 10, "-o", self.folder / "out.vtu", "--record", runs,
                           "--oversubscribe", "--algorithm", algorithm, "--log", self.log, *arguments)
        self.assert_exit(process, 0)
        return json.loads(runs.read_text().splitlines()[-1])

    def test_meshes_verify_and_runs_equal_their_replay(self):
        for arguments in few((["--threads", 4, "--nodes", 4, "--begging", "random", "--contention", "global"],
                              ON_BLADES, ["--threads", 1], ["--threads", 4, "--nodes", 2],
                              ["--threads", 6, "--cores-per-node", 1]), 2):
            with self.subTest(arguments=arguments):
                record = self.mesh("podm-home", "--verify", *arguments)
                self.assertEqual(record["algorithm"], "podm-home")
                self.assertEqual(set(record["verdicts"].values()), {"pass"})
                self.assertIsNone(record["leaves"])
                self.assert_exit(run_podm("replay", IMAGE, self.log), 0)

    def test_runs_are_the_same_for_the_same_seed(self):
        first, again, other = (self.mesh("podm-home", *ON_BLADES, "--seed", seed) for seed in (3, 3, 4))
        for name in "mesh_sha256", "outcomes", "virtual", "hops_by_kind":
            self.assertEqual(first[name], again[name], name)
        self.assertNotEqual(first["mesh_sha256"], other["mesh_sha256"])

    def test_nodes_find_in_their_own_memory_what_they_work_on(self):
        zero_hops = {}
        for algorithm in "podm", "podm-home":
            hops = self.mesh(algorithm, *ON_BLADES)["hops"]
            zero_hops[algorithm] = hops[0] / sum(hops)
        self.assertGreater(zero_hops["podm-home"], 0.8)
        self.assertGreater(zero_hops["podm-home"], 1.2 * zero_hops["podm"])

    def test_of_one_node_it_is_podm(self):
        hashes = {self.mesh(algorithm, "--executor", "virtual", "--threads", 8, *nodes)["mesh_sha256"]
                  for algorithm, nodes in (("podm", []), ("podm-home", ["--nodes", 1]))}
        self.assertEqual(len(hashes), 1)


if __name__ == "__main__":
    unittest.main()
