"""scripts/measure_images with programs made up for the test: which runs are met, and the table of them."""
import json
import tempfile
import unittest
from pathlib import Path

from test_programs import call

# Writes a record unless given --radius; its labels claim fails with --delta.
PODM = """#!/bin/sh
case "$*" in *--radius*) exit 2;; *--delta*) labels=fail;; *) labels=pass;; esac
[ "$1" = mesh ] || exit 0
while [ $# -gt 0 ]; do [ "$1" = --record ] && record=$2; shift; done
echo '{"cells": 1234, "stop_reason": "complete", "verdicts": {"labels": "'$labels'", "size": "pass"}}' > "$record"
[ $labels = pass ]
"""
VERIFIER = "#!/bin/sh\nexit 1\n"  # of schedules


class MeasureImages(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        for name, text in (("podm", PODM), ("podm-verify", VERIFIER), ("a.nrrd", ""), ("b.nii.gz", "")):
            (self.folder / name).write_text(text)
            (self.folder / name).chmod(0o700)

    def measure(self, *options):
        """Exit code, and the cells of the table's rows."""
        done = call("measure_images", "--bin", self.folder, "--cells", "1000", self.folder, self.folder / "runs.jsonl", *options)
        return done.returncode, [[cell.strip() for cell in line.split("|")[1:-1]] for line in done.stdout.splitlines()]

    def test_a_line_for_each_image_and_a_column_for_each_configuration(self):
        code, table = self.measure("--threads", "2", ",", "--delta", "3", ",", "--radius", "1", ",", "--algorithm", "pdr")
        self.assertEqual(code, 1)
        self.assertEqual(table[0], ["image", "asked", "--threads 2", "--delta 3", "--radius 1", "--algorithm pdr"])
        outcomes = ["met, 1,234 cells, replayed", "UNMET: labels", "UNMET: no mesh", "UNMET: schedule"]
        self.assertEqual(table[2:], [["b.nii.gz", "1,000", *outcomes], ["a.nrrd", "1,000", *outcomes]])
        rows = [json.loads(line) for line in (self.folder / "runs.jsonl").read_text().splitlines()]
        self.assertEqual(len(rows), 6, "a record of each mesh")

    def test_all_met_exits_with_0_and_no_image_with_2(self):
        self.assertEqual(self.measure()[0], 0)
        for image in "a.nrrd", "b.nii.gz":
            (self.folder / image).unlink()
        self.assertEqual(self.measure()[0], 2)


if __name__ == "__main__":
    unittest.main()
