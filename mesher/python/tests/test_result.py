"""The returned mesh: arrays that are views, files, quality, proofs, and conversion to other packages."""

import gc
import json
import re
import subprocess
import sys
import unittest
import unittest.mock
import warnings
import weakref

import nibabel
import numpy as np

from balls import AFFINE, PROGRAM, TestCase, balls, podm


class ResultTest(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = podm.mesh(balls(), affine=AFFINE, radius=1.5, names={3: "liver"})

    def test_arrays_have_the_documented_shapes_and_types(self):
        mesh = self.mesh
        num_points, num_cells, num_facets = (mesh.record[key] for key in ("vertices", "cells", "boundary_facets"))
        for array, shape, dtype in ((mesh.points, (num_points, 3), np.float64), (mesh.cells, (num_cells, 4), np.uint32),
                                    (mesh.labels, (num_cells,), np.uint32), (mesh.facets, (num_facets, 3), np.uint32),
                                    (mesh.facet_labels, (num_facets, 2), np.uint32)):
            self.assertEqual((array.shape, array.dtype), (shape, dtype))
        self.assertEqual(mesh.names, {3: "liver", 7: "label 7"})
        self.assertEqual((mesh.space, mesh.background, mesh.is_complete, mesh.unmet), ("RAS", 0, True, []))
        self.assert_valid(mesh)

    def test_normals_of_facets_point_from_the_second_label_to_the_first(self):
        mesh = self.mesh
        center = {value: mesh.points[mesh.cells[mesh.labels == value]].mean(axis=(0, 1)) for value in (3, 7)}
        for outside, value in ((0, 3), (0, 7), (3, 7)):
            corners = mesh.points[mesh.facets[(mesh.facet_labels == (outside, value)).all(axis=1)]]
            normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            outwards = ((corners.mean(axis=1) - center[value]) * normals).sum(axis=1)
            self.assertGreater((outwards > 0).mean(), 0.95, (outside, value))

    def test_views_share_memory_are_read_only_and_keep_it_alive(self):
        mesh = podm.mesh(balls(), radius=1.5)
        self.assertTrue(np.shares_memory(mesh.points, mesh.points))
        self.assertTrue(np.shares_memory(mesh.cells, mesh.cells))
        for array in (mesh.points, mesh.cells, mesh.facets):
            with self.assertRaises(ValueError):
                array[0] = 0
        points, expected = mesh.points, mesh.points.copy()
        del mesh
        gc.collect()
        podm.mesh(balls(), radius=1)  # would reuse the memory
        np.testing.assert_array_equal(points, expected)

    def test_labels_are_made_once_and_read_only(self):
        for name in ("labels", "facet_labels"):
            array = getattr(self.mesh, name)
            self.assertIs(getattr(self.mesh, name), array)
            with self.assertRaises(ValueError):
                array[:] = 77

    def converted(self, name):
        """Converts the file to .vtu with the program; returns its cells and the facets beside them."""
        path = self.folder / "converted.vtu"
        subprocess.run([PROGRAM, "convert", self.folder / name, path], capture_output=True, check=True)
        return self.files_of(path)

    def files_of(self, vtu):
        return vtu.read_bytes(), vtu.with_name(vtu.stem + "_facets.vtu").read_bytes()

    def test_every_format_of_the_program_is_written(self):
        with self.assertRaises(podm.Error) as refusal:
            self.mesh.save("mesh.obj")
        known = set(re.findall(r"\.[a-z]+(?=,| or|$)", str(refusal.exception).partition("expected")[2]))
        lossless = {".vtu", ".vtk", ".msh", ".mesh", ".e", ".exo", ".node", ".ele"}
        self.assertEqual(known, lossless | {".xdmf", ".inp"})
        self.mesh.save(self.folder / "own.vtu")
        for extension in sorted(lossless):
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                self.mesh.save(self.folder / f"mesh{extension}")
            self.assertEqual(self.converted(f"mesh{extension}"), self.files_of(self.folder / "own.vtu"), extension)

    def test_the_arrays_beside_an_xdmf_are_the_meshs(self):
        self.mesh.save(self.folder / "mesh.xdmf")
        self.assertIn("mesh.h5:/cell_labels", (self.folder / "mesh.xdmf").read_text())
        held = (self.folder / "mesh.h5").read_bytes()
        for array in (self.mesh.points, self.mesh.cells, self.mesh.labels, self.mesh.facets):
            self.assertTrue(array.tobytes() in held)

    def test_abaqus_has_the_mesh_but_for_names_and_digits(self):
        import meshio
        with self.assertWarnsRegex(UserWarning, "'label 7' is label_7"):
            self.mesh.save(self.folder / "mesh.inp")
        self.converted("mesh.inp")
        read = meshio.read(self.folder / "converted.vtu")
        np.testing.assert_array_equal(read.cells_dict["tetra"], self.mesh.cells)
        np.testing.assert_array_equal(read.cell_data_dict["label"]["tetra"].ravel(), self.mesh.labels)
        np.testing.assert_allclose(read.points, self.mesh.points, rtol=1e-12)

    def test_what_a_format_loses_is_reported(self):
        named = podm.mesh(balls(), names={3: "Leber (links)"})
        for mesh, name, loss in ((named, "loss.inp", "were changed for sets"),
                                 (podm.mesh(balls(), names={3: "l" * 256}), "loss.exo", "cut to 255 bytes")):
            with self.assertWarnsRegex(UserWarning, rf"{name}: .*{loss}") as warned:
                mesh.save(self.folder / name)
            self.assertEqual(warned.filename, __file__)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            named.save(self.folder / "loss.exo")

    def test_the_version_of_gmsh_is_the_programs(self):
        for version, first in ((None, "4.1 1 8"), (4.1, "4.1 1 8"), ("2.2", "2.2 0 8"), (2.2, "2.2 0 8")):
            self.mesh.save(self.folder / "mesh.msh", gmsh_version=version)
            self.assertTrue((self.folder / "mesh.msh").read_bytes().startswith(f"$MeshFormat\n{first}".encode()))
        self.mesh.save(self.folder / "own.vtu")
        self.assertEqual(self.converted("mesh.msh"), self.files_of(self.folder / "own.vtu"))

    def test_surfaces_are_written_by_label(self):
        self.mesh.save_surfaces(str(self.folder / "surface.stl"))
        self.assertTrue((self.folder / "surface_3_liver.stl").exists())

    def test_names_of_files_need_not_be_utf_8(self):
        path = self.folder / "\udcff.nii"
        self.nifti().rename(path)
        named = self.folder / "\udcfe.txt"
        named.write_bytes("3 Säule\n".encode("latin-1"))
        mesh = podm.mesh(path, names=named)
        self.assertEqual(mesh.names[3], "S\ufffdule")
        self.assertIn("S\ufffdule", str(mesh))
        self.assertTrue(mesh.verify())
        mesh.save(self.folder / "\udcff.vtu")
        mesh.save_surfaces(self.folder / "\udcff.stl")
        self.assertTrue((self.folder / "\udcff.vtu").exists() and (self.folder / "\udcff_7.stl").exists())
        with self.assertRaisesRegex(podm.Error, "\ufffd.obj: unknown mesh extension"):
            mesh.save(self.folder / "\udcff.obj")

    def test_quality_has_the_extremes_of_the_record(self):
        quality, extremes = self.mesh.quality(), self.mesh.record["quality"]
        for name, extreme, key in (("radius_edge", max, "max_radius_edge"), ("circumradius", max, "max_radius_mm"),
                                   ("min_dihedral_deg", min, "min_dihedral_deg"),
                                   ("max_dihedral_deg", max, "max_dihedral_deg")):
            self.assertEqual(quality[name].shape, (len(self.mesh.cells),))
            self.assertAlmostEqual(extreme(quality[name]), extremes[key], places=9)
        self.assertLess(quality["radius_edge"].max(), 1.93)
        corners = self.mesh.points[self.mesh.cells]
        np.testing.assert_allclose(quality["volume"], np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6, rtol=1e-6)
        for label in self.mesh.record["labels"]:
            self.assertAlmostEqual(quality["volume"][self.mesh.labels == label["value"]].sum(), label["volume_mm3"], 6)

    def test_the_verifier_proves_what_the_mesh_promises(self):
        report = self.mesh.verify(fidelity=True)
        self.assertTrue(report and report.holds, report.text)
        self.assertEqual(set(report.verdicts), {"structure", "delaunay", "radius_edge", "boundary_angles", "size",
                                                "conformity", "surface", "labels", "surface_vertices", "fidelity"})
        self.assertIn("labels", str(report))
        self.assertEqual(set(report.details["claims"]), set(report.verdicts))

    def sizes(self):
        path = self.folder / "sizes.nii"
        affine = [[100, 0, 0, -150], [0, 100, 0, -150], [0, 0, 100, -150], [0, 0, 0, 1]]
        nibabel.save(nibabel.Nifti1Image(np.linspace(8, 30, 64, dtype=np.float32).reshape(4, 4, 4), affine), path)
        return path

    def test_the_verifier_proves_meshes_of_files_phantoms_and_chosen_labels(self):
        for labels, keywords in ((self.nifti(), {"keep": [3]}), (balls(), {"merge": {"both": [3, 7]}}),
                                 ("phantom:spheres@24", {"radius_of": {1: 3}}),
                                 ("phantom:spheres@24", {"size_image": self.sizes(), "grade": 0.3,
                                                         "size_near": {("shell", 0): (3, 5), (1, 2): 4}}),
                                 (balls(), {"optimize": True, "radius": 1.5})):
            mesh = podm.mesh(labels, **keywords)
            self.assertTrue(mesh.verify(), mesh.verify().text)

    def test_the_verifier_refutes_a_mesh_of_another_image(self):
        path = self.nifti()
        mesh = podm.mesh(path, radius=1.5)
        self.nifti(np.roll(balls(), 2, axis=1))
        report = mesh.verify()
        self.assertFalse(report)
        self.assertEqual(report.verdicts["labels"], "fail")
        self.assertEqual(report.verdicts["delaunay"], "pass")

    def test_the_record_is_the_programs(self):
        path = self.nifti()
        expected = self.record_of_program(path, "--radius", 1.5)
        record = podm.mesh(path, radius=1.5).record
        self.assertEqual(record.keys(), expected.keys())
        for key in ("algorithm", "input", "options", "used", "cells", "labels", "facet_pairs", "quality", "guarantees",
                    "mesh_sha256", "stop_reason"):
            self.assertEqual(record[key], expected[key], key)
        self.assertEqual(json.loads(json.dumps(record)), record)

    def test_a_limit_ends_a_run_early_with_a_valid_mesh(self):
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            mesh = podm.mesh("phantom:spheres@64", radius=0.5, max_elements=5000)
        self.assertFalse(mesh.is_complete)
        self.assertEqual(mesh.stop_reason, "element limit")
        self.assertIn("ended early: element limit", repr(mesh))
        self.assertIn("element limit", " ".join(mesh.unmet))
        self.assertTrue(any("element limit" in str(warning.message) and warning.filename == __file__
                            for warning in warned))
        self.assert_valid(mesh)

    def test_text_has_the_essentials(self):
        mesh = self.mesh
        self.assertIn(f"{len(mesh.cells)} cells", repr(mesh))
        self.assertIn("liver", repr(mesh))
        self.assertIn("guarantees all met", str(mesh))

    def test_other_frames_are_other_coordinates(self):
        by_space = {space: podm.mesh(balls(), affine=AFFINE, space=space).points for space in ("RAS", "LPS", "voxel")}
        ras = np.unique(by_space["RAS"].round(6) + 0.0, axis=0)
        lps = np.unique((by_space["LPS"] * (-1, -1, 1)).round(6) + 0.0, axis=0)
        voxel = np.unique((by_space["voxel"] @ AFFINE[:3, :3].T + AFFINE[:3, 3]).round(6) + 0.0, axis=0)
        np.testing.assert_allclose(lps, ras)
        np.testing.assert_allclose(np.sort(voxel, axis=0), np.sort(ras, axis=0), atol=1e-5)


class OtherPackagesTest(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = podm.mesh(balls(), affine=AFFINE, radius=1.5, names={3: "liver"})

    def test_vtk_looks_at_the_memory_of_the_mesh(self):
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
        grid = self.mesh.to_vtk()
        for array, own in ((grid.GetPoints().GetData(), self.mesh.points),
                           (grid.GetCellData().GetScalars(), self.mesh.labels)):
            self.assertTrue(np.shares_memory(vtk_to_numpy(array), own))
        self.assertEqual(grid.GetCellData().GetScalars().GetName(), "label")
        sizes = vtk.vtkCellSizeFilter()
        sizes.SetInputData(grid)
        sizes.Update()
        volumes = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume"))
        np.testing.assert_allclose(volumes, self.mesh.quality()["volume"], rtol=1e-6)

    def test_vtk_has_the_facets_and_their_pairs_of_labels(self):
        from vtk.util.numpy_support import vtk_to_numpy
        surface = self.mesh.facets_to_vtk()
        corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        np.testing.assert_array_equal(corners, self.mesh.facets)
        self.assertTrue(np.shares_memory(vtk_to_numpy(surface.GetPoints().GetData()), self.mesh.points))
        pairs = [vtk_to_numpy(surface.GetCellData().GetArray(name)) for name in ("label_a", "label_b")]
        np.testing.assert_array_equal(np.column_stack(pairs), self.mesh.facet_labels)

    def test_vtk_has_the_fields_of_the_file(self):
        import vtk
        self.mesh.save(self.folder / "mesh.vtu")
        for made, name in ((self.mesh.to_vtk(), "mesh.vtu"), (self.mesh.facets_to_vtk(), "mesh_facets.vtu")):
            reader = vtk.vtkXMLUnstructuredGridReader()
            reader.SetFileName(str(self.folder / name))
            reader.Update()
            self.assertEqual(self.fields_of(made), self.fields_of(reader.GetOutput()))
            self.assertIn(("label:liver", 3), self.fields_of(made))

    def fields_of(self, grid):
        arrays = [grid.GetFieldData().GetArray(index) for index in range(grid.GetFieldData().GetNumberOfArrays())]
        return [(array.GetName(), array.GetTuple1(0)) for array in arrays]

    def test_a_missing_package_is_named(self):
        for convert, package in ((self.mesh.to_meshio, "meshio"), (self.mesh.to_vtk, "vtk"),
                                 (self.mesh.facets_to_vtk, "vtk")):
            with unittest.mock.patch.dict(sys.modules, {package: None}):
                with self.assertRaisesRegex(ModuleNotFoundError, f"needs the Python package {package}.*python3-"):
                    convert()

    def test_vtk_keeps_the_memory_alive(self):
        from vtk.util.numpy_support import vtk_to_numpy
        mesh = podm.mesh(balls(), radius=1.5)
        expected = mesh.points.copy(), mesh.cells.ravel().copy(), mesh.labels.copy()
        grid = mesh.to_vtk()
        memory = weakref.ref(mesh._made)
        del mesh
        gc.collect()
        podm.mesh(balls(), radius=1)
        data = grid.GetPoints().GetData(), grid.GetCells().GetConnectivityArray(), grid.GetCellData().GetScalars()
        for array, values in zip(data, expected):
            np.testing.assert_array_equal(vtk_to_numpy(array), values)
        del grid, data, array
        self.mesh.to_vtk()  # makes VTK release what it no longer needs
        gc.collect()
        self.assertIsNone(memory())

    def test_meshio_writes_and_reads_it(self):
        import meshio
        path = self.folder / "by_meshio.vtu"
        self.mesh.to_meshio().write(path)
        read = meshio.read(path)
        np.testing.assert_array_equal(read.points, self.mesh.points)
        np.testing.assert_array_equal(read.cells_dict["tetra"], self.mesh.cells)
        np.testing.assert_array_equal(read.cells_dict["triangle"], self.mesh.facets)
        np.testing.assert_array_equal(read.cell_data_dict["label"]["tetra"], self.mesh.labels)
        pairs = [read.cell_data_dict[name]["triangle"] for name in ("label_a", "label_b")]
        np.testing.assert_array_equal(np.column_stack(pairs), self.mesh.facet_labels)
        fields = {name: list(value) for name, value in self.mesh.to_meshio().field_data.items()}
        self.assertEqual(fields, {"liver": [3, 3], "label 7": [7, 3]})


if __name__ == "__main__":
    unittest.main()
