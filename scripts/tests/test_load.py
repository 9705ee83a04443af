"""Which rows are read, which give a number, and what is said of the others."""
import json
import tempfile
import unittest
from pathlib import Path

import paths
import synthetic
from figures.load import RecordError, load


class Load(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name) / "weak.jsonl"

    def load(self, *rows, tail=""):
        self.file.write_text("".join(json.dumps(row) + "\n" for row in rows) + tail)
        return load([self.file])

    def test_reads_folders_and_flattens(self):
        self.load(synthetic.row(), synthetic.row(cores=2))
        records = load([self.file.parent])
        self.assertEqual(list(records.frame["cores"]), [1, 2])
        self.assertAlmostEqual(records.frame["seconds"][0], 27.18)  # all phases but write
        self.assertEqual(records.frame["environment.kernel"][0], "Linux")
        self.assertEqual(records.problems, [])

    def test_refuses_other_schemas_by_name(self):
        for version in (0, 3, "podm-verify/1"):
            with self.subTest(version=version), self.assertRaisesRegex(RecordError, rf"weak.jsonl:2: schema '?{version}"):
                self.load(synthetic.row(), synthetic.row(schema=version))

    def test_a_broken_last_line_is_reported_and_skipped(self):
        records = self.load(synthetic.row(), tail='{"schema": 2, "exp')
        self.assertEqual(len(records.frame), 1)
        self.assertRegex(records.problems[0], r"weak.jsonl:2: last line is broken")

    def test_a_broken_line_elsewhere_is_an_error(self):
        self.file.write_text('{"schema"\n' + json.dumps(synthetic.row()) + "\n")
        with self.assertRaisesRegex(RecordError, r"weak.jsonl:1: not JSON"):
            load([self.file])

    def test_files_of_other_rows_are_reported_and_skipped(self):
        records = self.load({"kind": "alone", "cells": 3})
        self.assertEqual(len(records.frame), 0)
        self.assertIn("has no `schema`", records.problems[0])

    def test_missing_files_are_errors(self):
        with self.assertRaisesRegex(RecordError, "no such file"):
            load([self.file])

    def test_rows_that_give_no_number_say_why(self):
        passed = synthetic.PASSED
        for changes, reason in (
            ({"verdicts": {**passed, "delaunay": "fail"}}, "claim delaunay failed"),
            ({"verdicts": {**passed, "structure": "not_run"}}, "claim structure was not run"),
            ({"verdicts": {**passed, "fidelity": "fail"}}, "claim fidelity failed"),
            ({"verdicts": {}}, "not verified"),
            ({"status": "timed_out", "reason": "after 600 s"}, "timed_out: after 600 s"),
            ({"warmup": True}, "warm-up"),
            ({"threads": {"asked": 4, "used": 4}}, "4 threads on 2 cores"),
        ):
            with self.subTest(reason=reason):
                frame = self.load(synthetic.row(**changes)).frame
                self.assertFalse(frame["headline"][0])
                self.assertIn(reason, frame["doubt"][0])

    def test_claims_without_their_input_do_not_spoil_a_row(self):
        frame = self.load(synthetic.row(verdicts={**synthetic.PASSED, "fidelity": "not_run"})).frame
        self.assertTrue(frame["headline"][0])

    def test_a_trial_without_a_mesh_is_a_row(self):
        row = {key: value for key, value in synthetic.row(status="failed").items()
               if key not in ("phases_s", "cells", "verdicts", "threads", "quality")}
        frame = self.load(row).frame
        self.assertEqual((len(frame), bool(frame["headline"][0])), (1, False))

    def test_reads_the_reference_runs(self):
        self.assertTrue(load([paths.REFERENCE]).frame["headline"].any())

    def test_a_reference_file_holds_measured_or_simulated_rows(self):
        for path in paths.REFERENCE.glob("*.jsonl"):
            frame = load([path]).frame
            if not frame.empty:
                expected = "simulated" if "virtual" in path.name or "simulated" in path.name else "measured"
                with self.subTest(path=path.name):
                    self.assertEqual(set(frame["basis"]), {expected})


if __name__ == "__main__":
    unittest.main()
