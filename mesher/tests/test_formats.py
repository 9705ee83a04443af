"""Every mesh format: podm-verify proves what podm writes, and podm convert converts one format to another."""

import collections
import json
import re
import shutil
import subprocess
import unittest

from podm_process import PodmTestCase, run_podm

LOSSLESS = (".vtk", ".msh", ".e", ".exo", ".node", ".ele", ".mesh")
TWO_CELLS = """MeshVersionFormatted 2
Dimension 3
Vertices 5
0 0 0 0
1 0 0 0
0 1 0 0
0 0 1 0
1 1 1 0
Tetrahedra 2
1 2 3 4 {0}
2 3 4 5 {1}
End
"""


class FormatsTest(PodmTestCase):
    def mesh(self, name, *options):
        path = self.folder / name
        self.assert_exit(run_podm("mesh", "phantom:spheres@24", "--radius", 20, "--quiet", "-o", path, *options), 0)
        return path

    def convert(self, source, name, *options):
        process = run_podm("convert", source, self.folder / name, *options)
        self.assert_exit(process, 0)
        return process

    def test_what_every_format_holds_is_proved(self):
        for name, *options in [("a" + extension,) for extension in (*LOSSLESS, ".inp")] + [
                ("b.msh", "--gmsh-version", "2.2")]:
            with self.subTest(name=name, options=options):
                self.mesh(name, "--verify", *options)

    def test_a_mesh_comes_back_to_the_bit_from_every_format_that_can_hold_it(self):
        cells, facets = (self.mesh("a.vtu").with_name(name) for name in ("a.vtu", "a_facets.vtu"))
        for name, *options in [("b" + extension,) for extension in LOSSLESS] + [("c.msh", "--gmsh-version", "2.2")]:
            with self.subTest(name=name, options=options):
                self.convert(cells, name, *options)
                self.convert(self.folder / name, "back.vtu")
                self.assertEqual((self.folder / "back.vtu").read_bytes(), cells.read_bytes())
                self.assertEqual((self.folder / "back_facets.vtu").read_bytes(), facets.read_bytes())

    def test_lines_come_back_to_the_bit_from_every_format_that_holds_promises(self):
        cells = self.mesh("a.vtu", "--lines")
        lines = cells.with_name("a_lines.vtu").read_bytes()
        for name, *options in [("b" + extension,) for extension in LOSSLESS] + [("c.msh", "--gmsh-version", "2.2")]:
            with self.subTest(name=name, options=options):
                self.convert(cells, name, *options)
                process = self.convert(self.folder / name, "back.vtu")
                self.assertNotIn("lines in the file", process.stderr)
                self.assertEqual((self.folder / "back.vtu").read_bytes(), cells.read_bytes())
                self.assertEqual((self.folder / "back_lines.vtu").read_bytes(), lines)

    def flat_box(self, name, *options):
        path = self.folder / name
        self.assert_exit(run_podm("mesh", "phantom:crystal@16", "--radius", 8, "--delta", 4, "--box", "flat",
                                  "--quiet", "-o", path, *options), 0)
        return path

    def test_what_every_format_holds_of_a_flat_box_is_proved(self):
        for name, *options in [("a" + extension,) for extension in (*LOSSLESS, ".inp")] + [
                ("b.msh", "--gmsh-version", "2.2")]:
            with self.subTest(name=name, options=options):
                record = self.folder / f"{name}.jsonl"
                self.flat_box(name, "--verify", "--record", record, *options)
                self.assertEqual(self.read_record(record)["verdicts"]["box"], "pass")

    def test_sides_of_a_flat_box_come_back_to_the_bit_from_every_format(self):
        cells = self.flat_box("a.vtu")
        facets = cells.with_name("a_facets.vtu").read_bytes()
        for name, *options in [("b" + extension,) for extension in LOSSLESS] + [("c.msh", "--gmsh-version", "2.2")]:
            with self.subTest(name=name, options=options):
                self.convert(cells, name, *options)
                process = self.convert(self.folder / name, "back.vtu")
                self.assertNotIn("flat box", process.stderr)
                self.assertEqual((self.folder / "back.vtu").read_bytes(), cells.read_bytes())
                self.assertEqual((self.folder / "back_facets.vtu").read_bytes(), facets)

    def test_sides_of_a_flat_box_come_back_from_abaqus(self):
        """Its coordinates are rounded, so that the files are not the same to the bit."""
        cells = self.flat_box("a.vtu")
        self.convert(cells, "a.inp")
        self.convert(cells, "before.mesh")
        self.assertNotIn("flat box", self.convert(self.folder / "a.inp", "after.mesh").stderr)
        before, after = (collections.Counter(self.references(self.folder / name))
                         for name in ("before.mesh", "after.mesh"))
        self.assertEqual(before, after)
        self.assertEqual({name[-6:] for name in before if " box " in name},
                         {"box i-", "box i+", "box j-", "box j+", "box k-", "box k+"})

    @staticmethod
    def references(path):
        """Returns the name of the reference of each triangle of a Medit file."""
        lines = path.read_text().splitlines()
        names = {line.split()[2]: line.split(" ", 5)[5] for line in lines if line.startswith("# pair ")}
        first = lines.index("Triangles") + 2
        return [names[line.split()[-1]] for line in lines[first:first + int(lines[first - 1])]]

    def test_a_flat_box_without_the_facets_of_its_sides_is_reported(self):
        cells = self.flat_box("a.vtu")
        cells.with_name("a_facets.vtu").unlink()
        self.assertIn("names no facets of its sides", self.convert(cells, "b.msh").stderr)
        self.assertNotIn(b'"box i-"', (self.folder / "b.msh").read_bytes())
        self.assertIn(b"promise box flat", (self.folder / "b.msh").read_bytes())

    def test_abaqus_keeps_all_but_what_it_says(self):
        process = self.convert(self.mesh("a.vtu", "--merge", "1,2=big sphere"), "a.inp")
        self.assertIn("'big sphere' is big_sphere", process.stderr)
        self.assertRegex(process.stderr,
                         "the names of 2 pairs of labels were changed for surfaces: '.*' is .*big_sphere")
        self.convert(self.folder / "a.inp", "b.msh")
        text = (self.folder / "b.msh").read_bytes()
        self.assertIn(b'"big sphere|', text)

    def test_cells_that_are_turned_over_and_labels_beyond_those_of_images(self):
        path = self.folder / "two.mesh"
        path.write_text(TWO_CELLS.format(7, 0))
        process = self.convert(path, "two.msh", "--gmsh-version", "2.2")
        self.assertIn("2 cells of 2 labels, 5 vertices, 7 facets", process.stderr)
        self.assertIn("RAS is assumed", process.stderr)
        path.write_text(TWO_CELLS.format(7, 7).replace("2 3 4 5", "3 2 4 5"))
        process = self.convert(path, "two.inp")
        self.assertIn("1 cells were negatively oriented", process.stderr)
        self.assertIn("2 cells of 1 labels, 5 vertices, 6 facets", process.stderr)

    def test_faulty_meshes_are_refused_and_nothing_is_written(self):
        faults = {"no.mesh": (TWO_CELLS.split("Tetrahedra")[0] + "End\n", "no tetrahedron"),
                  "minus.mesh": (TWO_CELLS.format(-1, 2), "label -1"),
                  "far.mesh": (TWO_CELLS.format(1, 2).replace("2 3 4 5 2", "2 3 4 9 2"), "tetrahedron 1"),
                  "nan.mesh": (TWO_CELLS.format(1, 2).replace("1 1 1 0", "1 nan 1 0"), "vertex 4"),
                  "thrice.mesh": (TWO_CELLS.format(1, 2).replace("Tetrahedra 2", "Tetrahedra 3\n2 3 4 1 1"),
                                  "more than two tetrahedra"),
                  "text.e": ("solid\n", "not a netCDF file"),
                  "new.exo": ("\x89HDF\r\n", "nccopy"),
                  "cut.inp": ("*NODE\n1, 0, 0\n", "line 2")}
        for name, (text, fault) in faults.items():
            with self.subTest(name=name):
                (self.folder / name).write_text(text, encoding="latin-1", newline="")
                self.assert_refused(["convert", self.folder / name, self.folder / "out.vtu"], name, fault)
        self.assert_refused(["convert", self.folder / "missing.vtu", self.folder / "out.vtu"], "missing.vtu")
        self.assert_refused(["convert", self.folder / "no.mesh", self.folder / "out.xyz"], "out.xyz", ".inp")
        self.assert_refused(["convert", self.folder / "no.mesh", self.folder / "out.vtu", "--gmsh-version", "2.2"],
                            "out.vtu", "Gmsh")

    def test_foreign_abaqus_input(self):
        path = self.folder / "foreign.inp"
        path.write_text("*Heading\n*Node\n" + "".join(f"{10 * i}, {p}\n" for i, p in enumerate(
            ("0., 0., 0.", "+1., 0., 0.", "0., 1., 0.", "0., 0., 1."), start=1)) +
            "*ELEMENT, type=C3D4, elset=Part-1\n1, 10, 20,\n30, 40\n*Step\n1, 2\n")
        process = self.convert(path, "a.msh")
        self.assertIn("1 cells of 1 labels, 4 vertices, 4 facets", process.stderr)
        self.assertIn(b'"Part-1"', (self.folder / "a.msh").read_bytes())
        sound = path.read_text()
        for old, new, fault in (("20,\n30, 40", "20,\n*Step", "ends after 2"), ("C3D4", "C3D99", "C3D99"),
                                ("+1.", "one", "line 4"), ("20, +", "10, +", "10 is given twice"),
                                ("*Step", "*INCLUDE, INPUT=a", "line 10"), ("type=C3D4, ", "", "TYPE=")):
            with self.subTest(fault=fault):
                path.write_text(sound.replace(old, new, 1))
                self.assert_refused(["convert", path, self.folder / "out.vtu"], "foreign.inp", fault)

    def test_an_exodus_file_that_is_cut_off_is_refused_and_a_damaged_one_never_ends_the_program(self):
        whole = self.mesh("a.e").read_bytes()
        path = self.folder / "b.e"
        for size in (*range(1, 2000, 97), *range(2000, len(whole) - 4, len(whole) // 20)):
            path.write_bytes(whole[:size])
            self.assert_refused(["convert", path, self.folder / "out.vtu"], "b.e")
        for place in range(4, 2000, 61):
            path.write_bytes(whole[:place] + b"\xff" + whole[place + 1:])
            self.assertIn(run_podm("convert", path, self.folder / "out.vtu").returncode, (0, 2), place)


class OpenedByOthers(PodmTestCase):
    """Programs of other projects find all cells, sets and names."""

    def mesh(self, name, *options):
        path = self.folder / name
        record = self.folder / "runs.jsonl"
        self.assert_exit(run_podm("mesh", "phantom:spheres@24", "--radius", 8, "--quiet", "--merge", "1=big one",
                                  "--record", record, "-o", path, *options), 0)
        return path, json.loads(record.read_text().splitlines()[-1])

    def test_vtk_reads_exodus(self):
        try:
            from vtkmodules.vtkIOExodus import vtkExodusIIReader
        except ImportError:
            self.skipTest("python3-vtk9 is not installed")
        path, record = self.mesh("a.e")
        reader = vtkExodusIIReader()
        reader.SetFileName(str(path))
        reader.UpdateInformation()
        blocks, sides = reader.ELEM_BLOCK, reader.SIDE_SET
        counts = {kind: {reader.GetObjectName(kind, i): reader.GetNumberOfEntriesInObject(kind, i)
                         for i in range(reader.GetNumberOfObjects(kind))} for kind in (blocks, sides)}
        cells = {label["name"]: label["cells"] for label in record["labels"]}
        self.assertEqual({name.split(" Type")[0].strip(): count for name, count in counts[blocks].items()}, cells)
        self.assertIn("big one", cells)
        self.assertEqual(sum(counts[sides].values()), record["boundary_facets"])
        self.assertTrue(any("big one" in name for name in counts[sides]))

    @unittest.skipUnless(shutil.which("tetgen"), "tetgen is not installed")
    def test_tetgen_reads_its_own_format(self):
        path, record = self.mesh("a.ele")
        process = subprocess.run(["tetgen", "-rNEF", path.with_suffix("")], capture_output=True, text=True)
        self.assertEqual(process.returncode, 0, process.stdout)
        found = re.search(r"Mesh tetrahedra: (\d+)", process.stdout)
        self.assertEqual(int(found.group(1)), record["cells"], process.stdout)

    @unittest.skipUnless(shutil.which("gmsh"), "gmsh is not installed")
    def test_gmsh_reads_both_versions(self):
        for version in ("4.1", "2.2"):
            path, record = self.mesh(f"v{version[0]}.msh", "--gmsh-version", version)
            process = subprocess.run(["gmsh", "-save", "-format", "msh22", "-o", self.folder / "back.msh", path],
                                     capture_output=True, text=True)
            self.assertEqual(process.returncode, 0, process.stdout)
            self.assertIn(f"{record['vertices']} nodes", process.stdout)
            text = (self.folder / "back.msh").read_text()
            self.assertIn('"big one"', text)
            elements = text.split("$Elements\n", 1)[1].split("\n")[1:]
            self.assertEqual(sum(line.split(" ", 2)[1] == "4" for line in elements if line.count(" ") > 1),
                             record["cells"])


class LinesOpenedByOthers(PodmTestCase):
    """Programs of other projects find the lines of a mesh, with their names and edges."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        try:
            import vtk
            from vtkmodules.util.numpy_support import vtk_to_numpy
        except ImportError:
            raise unittest.SkipTest("python3-vtk9 is not installed") from None
        cls.vtk, cls.to_numpy = vtk, staticmethod(vtk_to_numpy)

    def expected(self):
        """Returns the edges of each line by its name, as vertices of the mesh, from the files of VTK."""
        self.assert_exit(run_podm("mesh", "phantom:spheres@24", "--radius", 8, "--quiet", "--lines", "-o",
                                  self.folder / "a.vtu"), 0)
        reader = self.vtk.vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(self.folder / "a_lines.vtu"))
        reader.Update()
        grid = reader.GetOutput()
        ends = self.to_numpy(grid.GetPointData().GetArray("vertex"))[
            self.to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 2)]
        numbers = self.to_numpy(grid.GetCellData().GetArray("line"))
        fields = grid.GetFieldData()
        names = {int(fields.GetArray(i).GetTuple1(0)): fields.GetArrayName(i).removeprefix("line:")
                 for i in range(fields.GetNumberOfArrays()) if fields.GetArrayName(i).startswith("line:")}
        self.assertEqual(list(names), list(range(len(names))))
        edges = {name: {tuple(sorted(edge)) for edge in ends[numbers == number].tolist()}
                 for number, name in names.items()}
        self.assertTrue(edges and all(edges.values()))
        return edges

    def converted(self, name, *options):
        path = self.folder / name
        self.assert_exit(run_podm("convert", self.folder / "a.vtu", path, *options), 0)
        return path

    def test_meshio_reads_gmsh_and_medit(self):
        try:
            import meshio
        except ImportError:
            self.skipTest("python3-meshio is not installed")
        expected = self.expected()
        names = list(expected)
        number_of = {tuple(point): number for number, point in enumerate(meshio.read(self.folder / "a.vtu").points)}
        for name, *options in (("v4.msh",), ("v2.msh", "--gmsh-version", "2.2"), ("m.mesh",)):
            with self.subTest(name=name):
                mesh = meshio.read(self.converted(name, *options))
                array = "medit:ref" if name.endswith(".mesh") else "gmsh:physical"
                found = {}
                for block, numbers in zip(mesh.cells, mesh.cell_data[array]):
                    if block.type == "line":
                        for edge, number in zip(block.data.tolist(), numbers):
                            ends = sorted(number_of[tuple(mesh.points[end])] for end in edge)
                            found.setdefault(names[number - 1], set()).add(tuple(ends))
                self.assertEqual(found, expected)
                if name.endswith(".msh"):
                    self.assertEqual({name for name, (_, size) in mesh.field_data.items() if size == 1}, set(names))

    def test_vtk_reads_the_node_sets_of_exodus(self):
        expected = self.expected()
        from vtkmodules.vtkIOExodus import vtkExodusIIReader
        reader = vtkExodusIIReader()
        reader.SetFileName(str(self.converted("a.e")))
        reader.UpdateInformation()
        sets = {reader.GetObjectName(reader.NODE_SET, i).split(" ID:")[0]:
                reader.GetNumberOfEntriesInObject(reader.NODE_SET, i)
                for i in range(reader.GetNumberOfObjects(reader.NODE_SET))}
        self.assertEqual(sets, {name: len({v for edge in edges for v in edge}) for name, edges in expected.items()})

    def test_node_sets_of_abaqus_have_the_vertices_of_the_lines(self):
        expected = self.expected()
        text = self.converted("a.inp").read_text()
        names = dict(re.findall(r"^\*\* line nset (\S+) (.*)$", text, re.MULTILINE))
        sets = {names[name]: {int(number) - 1 for number in re.findall(r"\d+", numbers)}
                for name, numbers in re.findall(r"^\*NSET, NSET=(\S+)\n([\d,\s]+)", text, re.MULTILINE)}
        self.assertEqual(sets, {name: {v for edge in edges for v in edge} for name, edges in expected.items()})
        self.assertLessEqual(max(line.count(",") for line in text.splitlines() if line[:1].isdigit()), 15)

    def test_xdmf_describes_the_edges_and_their_lines(self):
        try:
            import h5py
        except ImportError:
            self.skipTest("python3-h5py is not installed")
        expected = self.expected()
        with h5py.File(self.converted("a.xdmf").with_suffix(".h5")) as arrays:
            names = [name.decode() for name in arrays["line_sets/name"]]
            found = {}
            for edge, tag in zip(arrays["lines"][:].tolist(), arrays["line_tags"][:]):
                found.setdefault(names[tag - 1], set()).add(tuple(sorted(edge)))
        self.assertEqual(found, expected)
        self.assertIn('<Grid Name="lines"', (self.folder / "a.xdmf").read_text())


if __name__ == "__main__":
    unittest.main()
