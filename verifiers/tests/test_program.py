"""podm-verify as a user runs it: exit codes, report, schema, bad input, the extracted cells."""

import json
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

import jsonschema

from medit_mesh import kuhn_cubes
from mutants import REGULAR, tetrahedron

VERIFIER = os.environ["PODM_VERIFIER"]
SCHEMA = json.loads((pathlib.Path(__file__).parents[2] / "results/schema/podm-verify.schema.json").read_text())


class ProgramTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.mesh = self.folder / "mesh.mesh"
        self.report = self.folder / "report.json"
        kuhn_cubes(3, 2, 2).write(self.mesh)

    def verify(self, *arguments, mesh=None):
        return subprocess.run([VERIFIER, mesh or self.mesh, *map(str, arguments)], capture_output=True, text=True,
                              timeout=60, check=False)

    def assert_exit(self, process, code):
        self.assertEqual(process.returncode, code, process.stdout + process.stderr)

    def read_report(self):
        report = json.loads(self.report.read_text())
        jsonschema.validate(report, SCHEMA)
        return report

    def test_a_sound_mesh_passes_every_claim_that_needs_nothing_else(self):
        process = self.verify("--json", self.report)
        self.assert_exit(process, 0)
        self.assertIn("left out: size (needs --radius), labels (needs --image), fidelity (needs --image)",
                      process.stdout)
        claims = self.read_report()["claims"]
        self.assertEqual({claim["verdict"] for claim in claims.values()}, {"pass"})
        self.assertNotIn("labels", claims)
        self.assertGreater(claims["delaunay"]["details"]["cospherical_facets"], 0)

    def test_a_claim_asked_for_without_its_input_is_not_run_and_fails(self):
        self.assert_exit(self.verify("--claims", "structure,labels,size", "--json", self.report), 1)
        claims = self.read_report()["claims"]
        self.assertEqual({name: claim["verdict"] for name, claim in claims.items()},
                         {"structure": "pass", "labels": "not_run", "size": "not_run"})

    def test_claims_that_rest_on_ids_are_not_run_on_a_mesh_without(self):
        mesh = tetrahedron(REGULAR)
        mesh.vertices[0, 0] = math.nan
        mesh.write(self.mesh)
        self.assert_exit(self.verify("--json", self.report), 1)
        claims = self.read_report()["claims"]
        self.assertEqual(claims.pop("structure")["verdict"], "fail")
        self.assertEqual({claim["verdict"] for claim in claims.values()}, {"not_run"})

    def test_the_worst_witness_is_named_and_extracted(self):
        mesh = kuhn_cubes(3, 2, 2)
        mesh.cells[7, [0, 1]] = mesh.cells[7, [1, 0]]
        mesh.write(self.mesh)
        bad = self.folder / "bad.vtu"
        process = self.verify("--json", self.report, "--extract-bad", bad)
        self.assert_exit(process, 1)
        self.assertIn("cells are positively oriented; cell 7", process.stdout)
        self.assertIn(7, [w["cells"][0] for w in self.read_report()["claims"]["structure"]["worst"]])
        extracted = self.verify("--claims", "structure", "--json", self.report, mesh=bad)
        self.assert_exit(extracted, 1)
        self.assertGreaterEqual(self.read_report()["mesh"]["cells"], 1)

    def test_a_left_handed_mesh_is_told_apart(self):
        mesh = kuhn_cubes(2, 1, 1)
        mesh.cells[:, [0, 1]] = mesh.cells[:, [1, 0]]
        mesh.write(self.mesh)
        process = self.verify("--claims", "structure")
        self.assert_exit(process, 1)
        self.assertIn("sound but left-handed", process.stdout)

    def test_results_do_not_depend_on_threads(self):
        reports = []
        for threads in 1, 3:
            self.verify("--json", self.report, "--threads", threads, "--radius", "0.5")
            claims = self.read_report()["claims"]
            for claim in claims.values():
                del claim["seconds"]
            reports.append(claims)
        self.assertEqual(*reports)

    def test_bad_usage_and_input_exit_with_two_and_name_the_fault(self):
        for arguments, fault in ((["--claims", "beauty"], "no claim 'beauty'"),
                                 (["--radius", "-1"], "--radius"),
                                 (["--radius-of", "3"], "LABEL=MM"),
                                 (["--extract-bad", "x.txt"], ".vtu"),
                                 (["--image", self.folder / "absent.nii"], "absent.nii"),
                                 (["--schedule", self.folder / "absent.jsonl"], "absent.jsonl"),
                                 (["--json", self.folder / "absent" / "r.json"], "absent/r.json"),
                                 (["--unknown"], "--unknown")):
            process = self.verify(*arguments)
            self.assert_exit(process, 2)
            self.assertIn(fault, process.stderr)
        self.assert_exit(self.verify(mesh=self.folder / "absent.vtu"), 2)

    def test_faults_of_a_schedule_name_file_and_line(self):
        head = {"schema": "podm-schedule/1", "mesh_to_grid": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0],
                "leaves": [[0, 0, 0, 1]]}
        for lines, fault in (([{}], "line 1"),
                             ([{**head, "leaves": [[0, 0, 0, 3]]}], "power of two"),
                             ([head, {"leaf": 1}], "line 2"),
                             ([head, {"leaf": 0, "node": 0, "begin_s": 1, "end_s": 0}], "ends before it begins")):
            schedule = self.folder / "schedule.jsonl"
            schedule.write_text("\n".join(map(json.dumps, lines)))
            process = self.verify("--schedule", schedule)
            self.assert_exit(process, 2)
            self.assertIn("schedule.jsonl", process.stderr)
            self.assertIn(fault, process.stderr)


if __name__ == "__main__":
    unittest.main()
