"""Tests of podm-bench's rows against their schema, with the programs that PODM_BENCH, PODM and PODM_VERIFIER name."""

import copy
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import jsonschema

from slow import slow

ROOT = pathlib.Path(__file__).resolve().parents[2]
VALIDATOR = jsonschema.Draft202012Validator(
    json.loads((ROOT / "results/schema/podm-bench-row.schema.json").read_text()))

CLAIM = """
[[claims]]
name = "all-pass"
statement = "Every trial passes."
basis = "any"
kind = "share"
value = "passed"
at_least = 1.0
"""

EXPERIMENT = """
title = "T"
claim = "C"
[inputs.ball]
image = "phantom:torus@24"
[[trials]]
name = "trial"
input = "ball"
repeats = 2
warmup = 1
"""


def rows_of(experiment, mesh_body=None):
    """Returns the rows of a run of the experiment with the mesher, or with a shell script in its place."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, "exp.toml")
        path.write_text(experiment + CLAIM)
        podm = os.environ["PODM"]
        if mesh_body:
            podm = path.with_name("podm")
            podm.write_text(f'#!/bin/sh\n[ "$1" = mesh ] || exec "{os.environ["PODM"]}" "$@"\n{mesh_body}\n')
            podm.chmod(0o700)
        subprocess.run([os.environ["PODM_BENCH"], "run", path, "--results", folder, "--podm", podm, "--verifier",
                        os.environ["PODM_VERIFIER"]], check=False, capture_output=True, timeout=200)
        return [json.loads(line) for line in path.with_suffix(".jsonl").read_text().splitlines()]


LATENCY = """
title = "T"
claim = "C"
[[trials]]
name = "latency"
measure = "memory_latency"
"""


ALL_ASKED = """
title = "T"
claim = "C"
[inputs.ball]
image = "phantom:torus@24"
[[trials]]
name = "proved"
input = "ball"
target_elements = 3_000
replay = true
fidelity = true
[[trials]]
name = "copies"
input = "ball"
target_elements = 3_000
copies = "all"
[[trials]]
name = "growing"
input = "ball"
target_elements_per_thread = 3_000
threads = 2
oversubscribe = true
image_grows = true
"""


class MemoryLevels(unittest.TestCase):
    @slow
    def test_a_row_of_the_machine_fits_the_schema(self):
        (row,) = rows_of(LATENCY)
        VALIDATOR.validate(row)
        self.assertEqual(row["status"], "ok", row["reason"])
        self.assertGreaterEqual(len(row["latency"]), 10)
        caches = [level for level in row["memory_levels"] if "cache" in level["module"]]
        self.assertEqual([level["size_bytes"] for level in caches], sorted(level["size_bytes"] for level in caches))
        self.assertGreater(len(row["memory_levels"]), len(caches), "there is memory behind them")
        for level in ({"ns": 0}, {"cycles": "none"}, {"module": ""}, {"huge_page_share": 2}):
            broken = copy.deepcopy(row)
            broken["memory_levels"][0].update(level)
            self.assertFalse(VALIDATOR.is_valid(broken), level)


class Machine(unittest.TestCase):
    def test_identity_probe_and_load_fit_the_schema_and_their_faults_do_not(self):
        row = rows_of(EXPERIMENT)[-1]
        environment = row["environment"]
        self.assertEqual(set(environment["probe"]), {"chase_ns", "triad_gb_per_s", "integer_ns"})
        self.assertTrue(isinstance(environment["busy_elsewhere"], float)
                        or environment["busy_elsewhere"].startswith("unavailable: "), "a short trial has none")

        def fits(**changes):
            return VALIDATOR.is_valid(row | {"environment": environment | changes})

        identity = environment["identity"]
        self.assertTrue(fits(probe="unavailable: why", busy_elsewhere=1.5))
        self.assertTrue(VALIDATOR.is_valid(row | {"probe_moved": True}))
        self.assertFalse(VALIDATOR.is_valid(row | {"probe_moved": "yes"}))
        for changes in ({"probe": {}}, {"probe": environment["probe"] | {"chase_ns": 0}}, {"busy_elsewhere": -1},
                        {"busy_elsewhere": "none"}, {"identity": {}}, {"identity": identity | {"vendor": ""}},
                        {"identity": identity | {"cache_bytes": {}}}, {"identity": identity | {"family": "x"}}):
            self.assertFalse(fits(**changes), changes)
        older = {key: value for key, value in environment.items() if key not in ("identity", "probe", "busy_elsewhere")}
        VALIDATOR.validate(row | {"environment": older})


class Rows(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = rows_of(EXPERIMENT)
        cls.timed_out = rows_of(EXPERIMENT + "timeout_s = 0.1\n", "exec sleep 60")
        cls.failed = rows_of(EXPERIMENT, "exit 2")

    def test_each_kind_of_row_fits_the_schema(self):
        for rows, status in ((self.made, "ok"), (self.timed_out, "timed_out"), (self.failed, "failed")):
            self.assertEqual([row["status"] for row in rows], [status] * 3, rows[0]["reason"])
            self.assertEqual([(row["warmup"], row["repeat"]) for row in rows], [(True, 1), (False, 1), (False, 2)])
            self.assertEqual(len({row["key"] for row in rows}), 3)
            for row in rows:
                VALIDATOR.validate(row)

    def test_meshes_are_proved_and_repeats_alike(self):
        for row in self.made:
            self.assertEqual(set(row["verdicts"].values()), {"pass"})
            self.assertGreater(row["verification_s"], 0)
            for program in ("podm", "podm_verify"):
                self.assertIn("ITK", row["programs"][program]["build"]["libraries"])
            self.assertGreater(row["mesh_bytes"], 0)
            self.assertGreater(row["process"]["counters"]["page_faults"]["value"], 0)
        self.assertEqual(len({row["mesh_sha256"] for row in self.made}), 1)

    def test_rows_that_lack_a_key_or_lie_are_refused(self):
        for key in VALIDATOR.schema["required"] + VALIDATOR.schema["then"]["required"]:
            row = copy.deepcopy(self.made[0])
            del row[key]
            self.assertFalse(VALIDATOR.is_valid(row), key)
        for key, value in (("schema", 2), ("key", "x"), ("repeat", 0), ("status", "skipped"), ("harness_s", -1),
                           ("replay", "maybe"), ("resolved", {}), ("side_by_side", []), ("input", {"path": "a"})):
            self.assertFalse(VALIDATOR.is_valid(self.made[0] | {key: value}), key)
        by_hops = {kind: [5, 1] for kind in ("mesh_reads", "mesh_writes", "image_reads", "transform_reads")}
        of_array = {"as_claimed": 9, "elsewhere": 0, "untouched": 1}
        pages = dict.fromkeys(("cells", "vertices"), of_array) | {"accesses_by_hops": [5, 1]}
        for key, good, bad in (("hops", [5, 1], [5]), ("hops", "unavailable: w", 0), ("hops_by_kind", by_hops, {}),
                               ("hops_by_kind", by_hops | {"image_reads": "unavailable: w"}, "none"),
                               ("pages", {"refine": pages}, {"refine": pages | {"cells": {}}}), ("pages", {}, 0)):
            self.assertTrue(VALIDATOR.is_valid(self.made[0] | {key: good}), key)
            self.assertFalse(VALIDATOR.is_valid(self.made[0] | {key: bad}), key)
        counters = {"zero": 0, "without source": {"value": 1}, "reason": "none",
                    "share": {"value": 1, "source": "s", "running_share": 1}}
        for name, counter in counters.items():
            row = copy.deepcopy(self.made[0])
            row["process"]["counters"][name] = counter
            self.assertFalse(VALIDATOR.is_valid(row), name)
        self.assertFalse(VALIDATOR.is_valid(self.failed[0] | {"reason": ""}), "a failure without a reason")

    def test_rows_record_radius_replay_fidelity_and_copies(self):
        rows = {row["trial"]: row for row in rows_of(ALL_ASKED)}
        for row in rows.values():
            VALIDATOR.validate(row)
            self.assertEqual(row["status"], "ok", row["reason"])
            self.assertEqual(row["used"]["radius_mm"], row["resolved"]["radius_mm"])
            self.assertEqual(row["used"]["delta_mm"], row["resolved"]["delta_mm"])
            self.assertTrue(row["input"]["path"].endswith(".nii.gz"))
        self.assertEqual(rows["proved"]["replay"], "equal")
        self.assertEqual(rows["proved"]["verdicts"]["fidelity"], "pass")
        self.assertEqual(rows["proved"]["resolved"], rows["copies"]["resolved"])
        processors = [copy["processor"] for copy in rows["copies"]["side_by_side"]]
        self.assertEqual(len(set(processors)), len(os.sched_getaffinity(0)))
        self.assertEqual(rows["copies"]["side_by_side"][0]["cells"], rows["copies"]["cells"])
        self.assertEqual(rows["growing"]["input"]["name"], "phantom:torus@30")
        self.assertEqual(max(rows["growing"]["input"]["size"]), 30)


if __name__ == "__main__":
    unittest.main()
