"""Tests scripts/whatif with a podm-bench that makes synthetic rows: its trials, its answers, its errors."""
import tempfile
import tomllib
import unittest
from pathlib import Path

import paths  # noqa: F401
from figures import whatif
from test_programs import call

MACHINE = "name = 'Synthetic'\n[processor]\nsockets_per_node = 2\ncores_per_socket = 8\n[network]\nnodes = 16\n"
# On 256 cores PDR.PODM keeps 70 % efficiency. PODM keeps 90 % up to LAST cores, with no more cells per second beyond.
# PODM at home has the efficiency HOME. LACKING, an (algorithm, cores), has no row.
BENCH = """#!/usr/bin/python3
import json, sys, tomllib
sys.path.insert(0, "{tests}")
import synthetic
_, _, experiment, _, folder = sys.argv
name = experiment.split("/")[-1].removesuffix(".toml")
with open(experiment, "rb") as file:
    trials = tomllib.load(file)["trials"]
rows = [row for trial in trials for row in synthetic.simulated_size(
    10_000, lambda algorithm, cores: {{"podm": 0.9 * min(cores, {last}), "pdr-podm": 0.7 * cores,
                                      "podm-home": {home} * cores}}[algorithm],
    counts=[trial["threads"]], algorithms=trial["algorithm"], status="{status}")]
rows = [row for row in rows if (row["algorithm"], row["threads"]["used"]) != {lacking}]
with open(folder + "/" + name + ".jsonl", "w") as file:
    file.writelines(json.dumps(row | {{"experiment": name}}) + "\\n" for row in rows)
print("progress")
sys.exit({code})
"""


class WhatIf(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.machine = self.folder / "big.toml"
        self.machine.write_text(MACHINE)

    def ask(self, *arguments, last=128, home=0.1, lacking=None, status="ok", code=0):
        bench = self.folder / "bench"
        bench.write_text(BENCH.format(tests=Path(__file__).parent, last=last, home=home, lacking=lacking, status=status,
                                      code=code))
        bench.chmod(0o755)
        return call("whatif", self.machine, "--bench", bench, "-o", self.folder / "out", *arguments)

    def test_says_which_algorithm_from_which_count_on_and_draws_it(self):
        for last, home, words in ((128, 0.1, "podm up to 160 cores, pdr-podm from 192 on"),
                                  (256, 0.1, "podm on all numbers of cores up to 256"),
                                  (1, 0.1, "podm on one core, pdr-podm from 32 on"),
                                  (128, 0.8, "podm up to 128 cores, podm-home from 160 on"),
                                  (1, 0.8, "podm on one core, podm-home from 32 on")):
            with self.subTest(last=last, home=home):
                done = self.ask(last=last, home=home)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn(words, done.stdout)
                self.assertIn("simulated", done.stdout)
                self.assertIn("progress", done.stderr)
                self.assertNotIn("progress", done.stdout)
                self.assertGreater((self.folder / "out" / "whatif.png").stat().st_size, 10_000)

    def test_the_most_cores_list_all_rates_the_greatest_first(self):
        said = self.ask(home=0.8).stdout
        self.assertIn("on 256 cores: podm-home 20.5 (80 %), pdr-podm 17.9 (70 %), podm 11.5 (45 %)", said)
        self.assertNotIn("No verified run", said)

    def test_an_algorithm_without_a_run_is_named_and_the_others_compared(self):
        for lacking, words in ((("pdr-podm", 256), "pdr-podm from 192 to 224 cores, podm from 256 on"),
                               (("podm", 256), "podm up to 160 cores, pdr-podm from 192 on"),
                               (("podm", 64), "podm up to 32 cores, pdr-podm on 64 cores, podm from 96 to 160 cores")):
            with self.subTest(lacking=lacking):
                done = self.ask(lacking=lacking)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn(words, done.stdout)
                self.assertIn("No verified run of %s with this number of cells per core on %d:" % lacking, done.stdout)

    def test_trials_are_of_all_algorithms_on_one_to_all_cores(self):
        self.ask()
        (path,) = (self.folder / "out").glob("*.toml")
        trials = tomllib.loads(path.read_text())["trials"]
        self.assertEqual([trial["threads"] for trial in trials], [1, 32, 64, 96, 128, 160, 192, 224, 256])
        for trial in trials:
            at_home = ["podm-home"] if trial["threads"] > 1 else []
            self.assertEqual(trial["algorithm"], ["podm", "pdr-podm", *at_home])
            self.assertEqual((trial["executor"], trial["topology"]), ("virtual", str(self.machine.resolve())))
            self.assertEqual(trial.get("cores_per_node", 16), 16)

    def test_nodes_are_full_or_alone(self):
        self.assertEqual(whatif.core_counts(2, 64), [1, 16, 32, 48, 64, 128])
        self.assertEqual(whatif.core_counts(1, 2), [1, 2])
        self.assertEqual(whatif.core_counts(1, 1), [1])

    def test_bad_input_is_named(self):
        broken, small = self.folder / "broken.toml", self.folder / "small.toml"
        broken.write_text("[processor\n")
        small.write_text("[processor]\nsockets_per_node = 0\ncores_per_socket = 1\n")
        for arguments, words in (([self.folder / "none.toml"], "none.toml: No such file"), ([broken], "broken.toml"),
                                 ([small], "small.toml: processor.sockets_per_node must be a whole number"),
                                 ([self.machine, "--cells-per-core", "5"], "must be 1000 or more"),
                                 ([self.machine, "--bench", "/none/podm-bench"], "`make build` builds it"),
                                 ([], "the following arguments are required")):
            with self.subTest(words=words):
                done = call("whatif", *arguments, "-o", self.folder / "out")
                self.assertEqual(done.returncode, 2)
                self.assertIn(words, done.stderr)

    def test_trials_that_failed_are_no_answer(self):
        for done in (self.ask(code=1), self.ask(status="failed")):
            self.assertEqual(done.returncode, 2)
            self.assertEqual(done.stdout, "")
        self.assertIn("status failed", done.stderr)


if __name__ == "__main__":
    unittest.main()
