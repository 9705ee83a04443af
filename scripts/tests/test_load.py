"""Tests which rows are read, which give a number, and the reasons given for the others."""
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
        self.assertAlmostEqual(records.frame["seconds"][0], 27.18)  # all except write, calibrate, draw
        self.assertEqual(records.frame["environment.kernel"][0], "Linux")
        self.assertEqual(records.problems, [])

    def test_refuses_other_schemas_by_name(self):
        for version in (0, 1, 2, 3, "podm-verify/1"):
            fault = rf"weak.jsonl:2: schema '?{version}"
            with self.subTest(version=version), self.assertRaisesRegex(RecordError, fault):
                self.load(synthetic.row(), synthetic.row(schema=version))

    def test_a_broken_last_line_is_reported_and_skipped(self):
        records = self.load(synthetic.row(), tail='{"schema": 4, "exp')
        self.assertEqual(len(records.frame), 1)
        self.assertRegex(records.problems[0], r"weak.jsonl:2: last line is broken")

    def test_a_broken_line_elsewhere_is_an_error(self):
        self.file.write_text('{"schema"\n' + json.dumps(synthetic.row()) + "\n")
        with self.assertRaisesRegex(RecordError, r"weak.jsonl:1: not JSON"):
            load([self.file])

    def test_files_of_other_rows_are_skipped_and_reported_where_they_were_named(self):
        for other in ({"kind": "alone", "cells": 3}, {"schema": "podm-schedule/1"}):
            records = self.load(other)
            self.assertEqual(len(records.frame), 0)
            self.assertRegex(records.problems[0], "weak.jsonl: no rows of trials")
            self.assertEqual(load([self.file.parent]).problems, [])

    def test_lines_of_another_kind_in_a_folder_are_passed_over(self):
        self.load(synthetic.row())
        rounds = self.file.parent / "rounds.jsonl"
        rounds.write_text(json.dumps({"schema": 1, "round": 1, "processes": []}) + "\n")
        self.assertEqual(len(load([self.file.parent]).frame), 1)
        with self.assertRaises(RecordError):
            load([rounds])

    def test_folders_within_are_read_but_for_hidden_ones(self):
        self.load(synthetic.row())
        for name in ("default_tier", ".running"):
            (self.file.parent / name).mkdir()
            (self.file.parent / name / "more.jsonl").write_text(json.dumps(synthetic.row(cores=2)) + "\n")
        self.assertEqual(sorted(load([self.file.parent]).frame["cores"]), [1, 2])

    def test_of_rows_of_one_turn_the_last_counts(self):
        again = [synthetic.row(trial="1M", repeat=repeat, cells=cells, key=cells)
                 for repeat, cells in ((1, 1), (2, 2), (1, 3))]
        elsewhere = synthetic.row(trial="1M", cells=4, experiment="another")
        self.assertEqual(list(self.load(*again, elsewhere).frame["cells"]), [2, 3, 4])

    def test_seconds_of_virtual_workers_are_virtual(self):
        frame = self.load(synthetic.row(executor="virtual", phases_s={"read": 1.0, "refine": 7.0})).frame
        self.assertEqual((frame["seconds"][0], frame["refining_s"][0], frame["basis"][0]), (8, 8, "simulated"))

    def test_a_series_is_identified_by_its_trial(self):
        for trial, setting, image in (
            ("1M,algorithm=podm,threads=2,initial_ratio=4,seed=1", "1M,initial_ratio=4", "synthetic"),
            ("peers,mesher=cgal,input=abdomen", "peers", "synthetic"),
            ("0.5M-growing-4,threads=4", "0.5M-growing", ""),
            ("40k-on-128,algorithm=podm", "40k", "synthetic"),
        ):
            frame = self.load(synthetic.row(trial=trial, input={"name": "synthetic"})).frame
            self.assertEqual((frame["setting"][0], frame["image"][0]), (setting, image))

    def test_a_described_machine_is_identified_by_its_description(self):
        def virtual(sha256):
            machine = {"name": "Synthetic", "path": "synthetic.toml", "sha256": sha256,
                       "constants": {"core_speed": 0.1}}
            return {"cost": "measured", "refine_s": 1.0, "phases_s": {"refine": 1.0}, "machine": machine}

        rows = [synthetic.row(executor="virtual", virtual=virtual(one)) for one in ("aa" * 32, "bb" * 32)]
        machines = set(self.load(*rows, synthetic.row(executor="virtual"), synthetic.row()).frame["machine"])
        self.assertEqual(len(machines), 4, "two descriptions, none, and the processor")
        self.assertIn("Synthetic CPU", machines)

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


if __name__ == "__main__":
    unittest.main()
