"""podm mesh --algorithm auto: the algorithm that it chooses, and the source of the decision."""

import json
import os
import unittest

from podm_process import PodmTestCase, run_podm

IMAGE = "phantom:abdomen@40"
STORED = {"schema": "podm-crossover/2", "threads": 3, "measured_up_to": 8, "machine": {"cpu": "none such"}}
BLACKLIGHT = os.path.join(os.path.dirname(__file__), "../../experiments/machines/blacklight.toml")


class Auto(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.stored = self.folder / "crossover.json"
        self.out = self.folder / "out.vtu"
        self.store(STORED)

    def store(self, content):
        self.stored.write_text(content if isinstance(content, str) else json.dumps(content))

    def mesh(self, *arguments, stored=""):
        """Returns the record of a run whose environment names the file `stored`."""
        runs = self.folder / "runs.jsonl"
        process = run_podm("mesh", IMAGE, "--radius", 20, "--oversubscribe", "-o", self.out, "--record", runs,
                           *arguments, env=os.environ | {"PODM_CROSSOVER": str(stored)})
        self.assert_exit(process, 0)
        return json.loads(runs.read_text().splitlines()[-1])

    def test_is_podm_below_the_crossover_and_podm_home_from_it_on(self):
        for option in 3, self.stored:
            for threads, algorithm in (2, "podm"), (3, "podm-home"):
                record = self.mesh("--algorithm", "auto", "--threads", threads, "--crossover", option)
                self.assertEqual(record["algorithm"], algorithm)
                self.assertEqual(record["auto"]["threads"], 3)

    def test_the_option_goes_before_the_variable_and_that_before_the_default(self):
        for arguments, stored, expected in (((), "", {"source": "default", "threads": None}),
                                            (("--crossover", 5), self.stored, {"source": "option", "threads": 5}),
                                            ((), self.stored, {"source": "file", "threads": 3, "measured": 3,
                                                               "measured_up_to": 8, "path": str(self.stored),
                                                               "machine": STORED["machine"]})):
            self.assertEqual(self.mesh("--algorithm", "auto", *arguments, stored=stored)["auto"], expected)

    def test_a_file_of_another_processor_is_warned_of(self):
        record = self.mesh("--algorithm", "auto", stored=self.stored)
        self.assertTrue(any("none such" in warning for warning in record["warnings"]), record["warnings"])

    def test_podm_home_never_ahead_is_podm_as_far_as_measured(self):
        self.store(STORED | {"threads": None, "measured_up_to": 8})
        self.assertEqual(self.mesh("--algorithm", "auto", stored=self.stored)["auto"]["threads"], 9)

    def test_is_podm_home_on_several_numa_nodes(self):
        for threads, pin, algorithm in ((16, "compact", "podm"), (17, "compact", "podm"), (32, "none", "podm"),
                                        (32, "compact", "podm-home")):
            record = self.mesh("--algorithm", "auto", "--executor", "virtual", "--topology", BLACKLIGHT, "--pin", pin,
                               "--threads", threads)
            self.assertEqual(record["algorithm"], algorithm)

    def test_the_variable_is_not_for_virtual_time_nor_for_an_algorithm_that_is_named(self):
        self.store("broken")
        record = self.mesh("--algorithm", "auto", "--executor", "virtual", "--threads", 4, stored=self.stored)
        self.assertEqual(record["auto"]["source"], "default")
        self.assertIsNone(self.mesh(stored=self.stored)["auto"])

    def test_what_podm_bench_did_not_store_is_refused(self):
        for content, word in (("", "JSON"), ("[1]", "JSON"), ({"schema": "x"}, "schema"),
                              (STORED | {"threads": 0}, "threads"), (STORED | {"threads": "4"}, "threads"),
                              (STORED | {"threads": 1e9}, "threads"),
                              (STORED | {"measured_up_to": None}, "measured_up_to"),
                              (STORED | {"machine": 7}, "machine"), (STORED | {"machine": {}}, "machine")):
            with self.subTest(content=content):
                self.store(content)
                self.assert_refused(["mesh", IMAGE, "-o", self.out, "--crossover", self.stored], self.stored, word)
                self.assert_refused(["mesh", IMAGE, "-o", self.out, "--algorithm", "auto"], self.stored, word,
                                    env=os.environ | {"PODM_CROSSOVER": str(self.stored)})
        self.assert_refused(["mesh", IMAGE, "-o", self.out, "--crossover", self.folder / "absent"], "absent")
        for number in "0", "-1", "1025", "99999999999999999999":
            self.assert_refused(["mesh", IMAGE, "-o", self.out, "--crossover", number], "--crossover", number)


if __name__ == "__main__":
    unittest.main()
