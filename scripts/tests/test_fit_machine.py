"""Tests scripts/fit_machine: the rows that it uses, its messages on missing rows, and its output."""
import json
import math
import tempfile
import unittest
from pathlib import Path

import paths  # noqa: F401
import synthetic
from figures import fit_machine
from figures.load import RecordError
from test_figures import frame_of
from test_programs import call, write_rows
from slow import slow

COUNTS = (1, 32, 64, 128, 160, 192, 224, 256)
MACHINE = ("name = 'Synthetic'\n[processor]\nclock_ghz = 2.0\ncore_speed = 0.2\n[memory]\ncycles_per_hop = 1500\n")


def row_of(one, hops=(60, 30, 10)):
    """Adds the values of virtual workers that find a share of their reads two links away."""
    cores, cells = one["threads"]["used"], one["cells"]
    whole = cells * 1e-5
    one["virtual"].update(worker_s={"compute": whole, "memory_remote": 0.1 * whole, "network_queue": 0.0},
                          machine={"name": "Synthetic", "sha256": "ab" * 32, "constants": {"core_speed": 0.2}},
                          refine_s=1.1 * whole / cores)
    one["counters"] = {"cells_created": 4 * cells}
    reads = [cells * count for count in hops] if cores > 16 else "unavailable: one node"
    return {**one, "hops_by_kind": {"mesh_reads": reads, "mesh_writes": reads}}


def rows_of(counts=COUNTS, cells_per_core=40_000, **changes):
    return [row_of(one) for one in synthetic.simulated_size(cells_per_core, lambda _, cores: 0.5 * cores, counts=counts,
                                                            algorithms=("podm", "pdr-podm", "podm-home"), **changes)]


class Rows(unittest.TestCase):
    def runs(self, rows):
        return fit_machine.runs_of(frame_of(rows))[0]

    def refused(self, rows):
        with self.assertRaises(RecordError) as caught:
            self.runs(rows)
        return str(caught.exception)

    def test_those_of_podm_on_the_papers_numbers_of_cores_are_taken(self):
        runs = self.runs(rows_of((*COUNTS, 16)))
        self.assertEqual(tuple(runs), COUNTS)
        self.assertAlmostEqual(runs[256].links / runs[256].cells, 2 * (30 + 2 * 10))
        self.assertAlmostEqual(runs[256].routed / runs[256].cells, 2 * 10)
        self.assertEqual(runs[1].links, 0)
        self.assertTrue(all(math.isclose(run.loss, 1) for run in runs.values()))

    def test_hops_may_be_as_many_as_a_machine_has(self):
        rows = rows_of()
        rows[-1]["hops_by_kind"]["mesh_reads"] = [1] * 40
        self.assertEqual(tuple(self.runs(rows)), COUNTS)

    def test_the_newest_row_of_each_number_counts(self):
        newest = rows_of((256,))
        newest[0]["counters"]["cells_created"] = 22
        self.assertEqual(self.runs([*rows_of(), *newest])[256].insertions, 1)

    def test_rows_that_failed_or_are_of_another_size_or_machine_do_not_count(self):
        failed = {**synthetic.row(executor="virtual"), "status": "timed_out", "verdicts": None}
        for key in ("algorithm", "threads", "virtual", "cells", "phases_s"):
            failed.pop(key)
        other = [one | {"environment": one["environment"] | {"cpu": "Another"}} for one in rows_of((1, 256))]
        for one in other:
            one["virtual"]["machine"] = {"name": "Another", "sha256": "cd" * 32, "constants": {"core_speed": 1.0}}
        rows = [*rows_of(), failed, *rows_of((256,), cells_per_core=10_000), *other, *rows_of((256,), verdicts=None)]
        self.assertEqual(self.runs(rows), self.runs(rows_of()))

    def test_what_is_missing_is_reported(self):
        self.assertIn("no verified simulated row of podm on one core", self.refused([]))
        self.assertIn("on one core", self.refused(rows_of(COUNTS[1:])))
        self.assertIn("timed_out", self.refused(rows_of(status="timed_out")))
        self.assertIn("none on 128, 160, 192, 224, 256 cores", self.refused(rows_of(COUNTS[:3])))
        older = rows_of()
        for one in older:
            one["virtual"].pop("worker_s")
        self.assertIn("do not record virtual.worker_s.compute", self.refused(older))

    def test_an_older_row_among_newer_ones_does_not_count(self):
        rows = rows_of()
        rows[COUNTS.index(64)]["virtual"].pop("worker_s")
        self.assertEqual(fit_machine.missing(self.runs(rows)), [64])


class Program(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.machine = self.folder / "machine.toml"
        self.machine.write_text(MACHINE)

    def fit(self, rows):
        return call("fit_machine", write_rows(self.folder / "rows.jsonl", rows), "--machine", self.machine,
                    "-o", self.folder / "out")

    @slow
    def test_a_fit_is_written_and_says_which_rows_it_lacks(self):
        done = self.fit(rows_of((1, 32, 64, 128, 160)))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("no row on 192, 224, 256 cores", done.stderr)
        told = json.loads((self.folder / "out" / "machine_fit.json").read_text())
        self.assertEqual(set(told["constants"]), set(fit_machine.CONSTANTS))
        self.assertEqual(list(told["deviations"]), ["32", "64", "128", "160"])
        self.assertGreater((self.folder / "out" / "machine_fit.png").stat().st_size, 10_000)

    def test_bad_input_is_named(self):
        done = self.fit(rows_of(COUNTS[1:]))
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("no verified simulated row of podm on one core", done.stderr)
        for text, words in (("[memory\n", "machine.toml: "), ("name = 'x'\n", "memory.cycles_per_hop must be"),
                            (MACHINE.replace("0.2", "0"), "processor.core_speed must be")):
            self.machine.write_text(text)
            done = self.fit(rows_of())
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)
            self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    unittest.main()
