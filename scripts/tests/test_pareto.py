"""Tests the Pareto fronts and the reading of submissions, from synthetic rows."""
import io
import json
import tarfile
import tempfile
import unittest
from pathlib import Path

import paths  # noqa: F401
import pandas
import synthetic
from figures import pareto
from figures.load import RecordError, derived, load


def frame_of(rows):
    return pandas.json_normalize([{**row, **derived(row)} for row in rows], sep=".")


def mesh(cells, seconds, least, mesher=None, **changes):
    phases = {"phases_s": {"read": 5.0, "refine": seconds, "write": 9.0}}
    made = synthetic.peer(mesher, **phases) if mesher else synthetic.row(**phases)
    made.update(cells=cells, trial=f"{cells}", dihedral_deg={"least": least, "largest": 170.0, "counts": []}, **changes)
    return made


class Pareto(unittest.TestCase):
    def fronts(self, rows):
        table = pareto.pareto(frame_of(rows))
        return ({(line["maker"].split()[0], line["cells"]) for line in table.to_dict("records") if line["front_cells"]},
                {(line["maker"].split()[0], line["cells"]) for line in table.to_dict("records") if line["front_angle"]})

    def test_no_other_mesh_has_as_many_cells_as_soon(self):
        cells, _ = self.fronts([mesh(100, 1.0, 5), mesh(200, 2.0, 5), mesh(200, 4.0, 5, "slow"),
                                mesh(300, 3.0, 5, "fast")])
        self.assertEqual(cells, {("podm", 100), ("podm", 200), ("fast", 300)})

    def test_no_other_mesh_has_better_angles_for_less_time_per_cell(self):
        _, angles = self.fronts([mesh(100, 1.0, 5), mesh(100, 2.0, 4, "worse"), mesh(200, 4.0, 9, "better")])
        self.assertEqual(angles, {("podm", 100), ("better", 200)})

    def test_the_phases_that_improve_angles_take_time_and_reading_does_not(self):
        improved = mesh(100, 1.0, 9, asked={"min_dihedral": 8.0, "optimize": True})
        improved["phases_s"].update(perturb=2.0, optimize=3.0)
        table = pareto.pareto(frame_of([mesh(100, 1.0, 5), improved])).set_index("maker")
        self.assertEqual(table["seconds"].to_dict(), {"podm": 1.0, "podm, both stages": 6.0})

    def test_meshes_of_other_images_machines_and_cores_are_never_compared(self):
        other = synthetic.ROW["environment"] | {"cpu": "Another"}
        for changes in ({"input": {"name": "other.nii"}}, {"environment": other},
                        {"threads": {"asked": 2, "used": 2}}):
            self.assertTrue(pareto.pareto(frame_of([mesh(100, 1.0, 5), mesh(90, 9.0, 1, "one", **changes)])).empty)

    def test_rows_without_a_proved_mesh_and_simulated_rows_are_left_out(self):
        for changes in ({"status": "unmet"}, {"warmup": True}, {"executor": "virtual", "basis": "simulated"},
                        {"probe_moved": True}):
            self.assertTrue(pareto.pareto(frame_of([mesh(100, 1.0, 5), mesh(90, 9.0, 1, "one", **changes)])).empty,
                            changes)
        self.assertTrue(pareto.pareto(pandas.DataFrame()).empty)
        self.assertIsNone(pareto.figure(frame_of([mesh(100, 1.0, 5)])))

    def test_the_figure_states_what_a_front_is(self):
        drawn = pareto.figure(frame_of([mesh(100, 1.0, 5), mesh(90, 9.0, 1, "one")]))
        self.assertEqual(len(drawn.axes), 2)
        self.assertIn("no other mesh of the image has at least as many cells", drawn.get_label())


class Submissions(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "one.tar.gz"

    def pack(self, **files):
        with tarfile.open(self.path, "w:gz") as archive:
            for name, text in files.items():
                member = tarfile.TarInfo(name.replace("__", "/"))
                member.size = len(text)
                archive.addfile(member, io.BytesIO(text.encode()))

    def test_rows_of_archives_count_like_rows_of_files(self):
        line = json.dumps(synthetic.row()) + "\n"
        self.pack(**{"manifest.json": "{}", "rows__weak.jsonl": line, "logs__k__record.jsonl": '{"schema": 1}\n'})
        self.assertEqual(len(load([self.path.parent]).frame), 1)
        self.assertEqual(len(load([self.path]).frame), 1)

    def test_a_file_that_is_no_whole_archive_is_refused_by_name(self):
        self.pack(**{"rows__weak.jsonl": json.dumps(synthetic.row()) + "\n"})
        whole = self.path.read_bytes()
        for data in (whole[:-40], b"no archive", b""):
            self.path.write_bytes(data)
            with self.assertRaisesRegex(RecordError, "one.tar.gz: not a whole archive"):
                load([self.path])


if __name__ == "__main__":
    unittest.main()
