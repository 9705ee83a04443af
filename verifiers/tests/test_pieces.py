"""podm-verify on a mesh in pieces: the verdicts are those of one file, and pieces that do not fit are refused."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

from medit_mesh import kuhn_cubes
from pvtu_mesh import MeshInPieces

VERIFIER = os.environ["PODM_VERIFIER"]


def cubes_of_two_labels():
    """Returns cubes of two labels with the facets of both, in podm's format."""
    mesh = kuhn_cubes(4, 3, 2)
    mesh.cells[len(mesh.cells) // 2:, 4] = 2
    sides = {}
    for cell in mesh.cells:
        for k in range(4):
            facet = np.delete(cell[:4], k)
            turned = facet if k in (1, 3) else facet[[0, 2, 1]]  # makes its normal point out of the cell
            sides.setdefault(tuple(sorted(facet)), []).append((cell[4], turned))
    references = {(0, 1): 1, (0, 2): 2, (1, 2): 3}
    for around in sides.values():
        labels = (0, around[0][0]) if len(around) == 1 else tuple(sorted(label for label, _ in around))
        if labels[0] != labels[1]:
            facet = next(turned for label, turned in around if label == labels[1])
            mesh.facets = np.append(mesh.facets, [[*facet, references[labels]]], axis=0)
    mesh.comments = [f"# pair {number} {a} {b} names\n" for (a, b), number in references.items()]
    return mesh


class PiecesTest(unittest.TestCase):
    PREFIX = "podm-verify: "

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.index = self.folder / "m.pvtu"
        self.mesh = cubes_of_two_labels()
        self.pieces = MeshInPieces(self.mesh, 3)

    def verify(self, path, *options):
        return subprocess.run([VERIFIER, path, *options], capture_output=True, text=True, timeout=60, check=False)

    def report(self, path):
        report = self.folder / "report.json"
        process = self.verify(path, "--json", report)
        self.assertEqual(process.returncode, 0, process.stdout + process.stderr)
        return json.loads(report.read_text())

    def assert_refused(self, *words):
        """Expects a refusal that begins with the index and contains all words."""
        process = self.verify(self.index)
        self.assertEqual(process.returncode, 2, process.stdout + process.stderr)
        self.assertIn(f"{self.PREFIX}{self.index.with_suffix('')}", process.stderr)
        for word in words:
            self.assertIn(word, process.stderr)

    def write_and_refuse(self, *words):
        self.pieces.write(self.index)
        self.assert_refused(*words)

    def edit(self, name, old, new):
        path = self.folder / name
        text = path.read_text()
        self.assertIn(old, text)
        path.write_text(text.replace(old, new, 1))

    def test_claims_of_the_pieces_are_those_of_the_whole(self):
        whole = self.folder / "m.mesh"
        self.mesh.write(whole)
        expected = self.report(whole)
        for num_pieces in 1, 2, 5:
            MeshInPieces(self.mesh, num_pieces).write(self.index)
            found = self.report(self.index)
            for key in "cells", "vertices":
                self.assertEqual(found["mesh"][key], expected["mesh"][key])
            for name, claim in expected["claims"].items():
                for key in "verdict", "num_checked", "num_violations":
                    self.assertEqual(found["claims"][name][key], claim[key], name)

    def test_a_piece_without_cells_is_one(self):
        pieces = MeshInPieces(self.mesh, 2)
        pieces.pieces.append(MeshInPieces(self.mesh, 1000).pieces[1])
        self.assertEqual(len(pieces.pieces[2].cells), 0)
        pieces.index = [0, 2, 1]
        pieces.write(self.index)
        self.report(self.index)

    def test_facets_that_are_not_those_of_the_cells_are_found(self):
        self.pieces.pieces[1].facets = self.pieces.pieces[1].facets[1:]
        self.pieces.write(self.index)
        self.assertEqual(self.verify(self.index, "--claims", "surface").returncode, 1)

    def test_a_missing_piece(self):
        self.pieces.write(self.index)
        (self.folder / "m_1.vtu").unlink()
        self.assert_refused("m.pvtu: line 5, Piece: ", "m_1.vtu: No such file")

    def test_a_missing_piece_of_facets(self):
        self.pieces.write(self.index)
        (self.folder / "m_2_facets.vtu").unlink()
        self.assert_refused("m_facets.pvtu: line 6, Piece: ", "m_2_facets.vtu: No such file")

    def test_a_piece_named_twice(self):
        self.pieces.index.append(1)
        self.write_and_refuse("m.pvtu: line 7: Piece: m_1.vtu is named twice")
        self.edit("m.pvtu", "m_1.vtu", "../" + self.folder.name + "/./m_1.vtu")
        self.assert_refused("m_1.vtu is named twice")

    def test_a_piece_that_is_not_named(self):
        self.pieces.index = [0, 2]
        self.write_and_refuse("m.pvtu: GlobalNodeIds: no piece has vertex ")

    def test_numbers_with_gaps(self):
        for piece in self.pieces.pieces:
            piece.ids += 1
        self.write_and_refuse("no piece has vertex 0,")
        for piece in self.pieces.pieces:
            piece.ids += 1 << 31
        self.write_and_refuse("m_0.vtu: line ", "DataArray 'GlobalNodeIds': point 0: its number is not below ")
        for piece in self.pieces.pieces:
            piece.ids -= 1 << 32
        self.write_and_refuse("its number is not below ")

    def test_a_number_twice_in_a_piece(self):
        self.pieces.pieces[0].ids[1] = self.pieces.pieces[0].ids[0]
        self.write_and_refuse("m_0.vtu", "is twice in this piece")

    def test_coordinates_that_differ(self):
        piece, shared = self.pieces.pieces[1], self.pieces.shared_id()
        moved = np.flatnonzero(piece.ids == shared)[0]
        piece.points[moved, 1] = -0.0 if piece.points[moved, 1] == 0 else np.nextafter(piece.points[moved, 1], 9)
        there = "({}, {}, {})".format(*(f"{x:g}" for x in self.mesh.vertices[shared]))
        self.write_and_refuse("m_1.vtu: line ", f"point {moved}: vertex {shared} is at (", f"m_0.vtu at {there}")

    def test_facets_of_another_mesh(self):
        other = MeshInPieces(self.mesh, 3)
        other.pieces[2].points[0, 0] += 1
        other.write(self.index)
        facets = (self.folder / "m_2_facets.vtu").read_text()
        self.pieces.write(self.index)
        (self.folder / "m_2_facets.vtu").write_text(facets)
        self.assert_refused("m_2_facets.vtu: line ", "the files do not belong together")

    def test_spaces_and_labels_that_differ(self):
        for field, fault in (({"space:LPS": 1}, "the space is not that of the first piece"),
                             ({"space:RAS": 1, "promise:smoothed 2": 1},
                              "the width of smoothing is not that of the first piece"),
                             ({"space:RAS": 1, "label:liver": 1}, "label 1 is 'liver', in the first piece not named")):
            self.pieces.pieces[1].field = field
            self.write_and_refuse("m_1.vtu: FieldData: " + fault)

    def test_faults_of_the_index(self):
        self.pieces.index = []
        self.write_and_refuse("names no pieces")
        self.pieces.index = [0, 1, 2]
        for old, new, fault in (("PUnstructuredGrid\" ", "UnstructuredGrid\" ", "not PUnstructuredGrid"),
                                ("GhostLevel=\"0\"", "GhostLevel=\"1\"", "ghost cells"),
                                ("Source=", "Quelle=", "line 4: Piece: no Source"),
                                ("</VTKFile>", "", "line"),
                                ("m_1.vtu", ".", "not a regular file"),
                                ("m_1.vtu", "m.pvtu", "m.pvtu: line 2: VTKFile of type"),
                                ("<VTKFile", "<!DOCTYPE VTKFile [<!ENTITY a 'b'>]><VTKFile", "document type")):
            self.pieces.write(self.index)
            self.edit("m.pvtu", old, new)
            with self.subTest(new):
                self.assert_refused("m.pvtu: line ", fault)

    def test_pieces_without_numbers_or_with_other_labels(self):
        for old, new, fault in (("GlobalNodeIds", "Ids", "no DataArray 'GlobalNodeIds'"),
                                ('Name="label"', 'Name="tissue"', "cell labels in array 'tissue'")):
            self.pieces.write(self.index)
            self.edit("m_1.vtu", old, new)
            self.assert_refused("m_1.vtu: ", fault)


if __name__ == "__main__":
    unittest.main()
