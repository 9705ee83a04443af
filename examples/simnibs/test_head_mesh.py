"""A head mesh is a file as SimNIBS reads it, and Gmsh reads its groups and names."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import nibabel
import numpy as np

try:
    import gmsh
except ImportError:
    gmsh = None

HERE = pathlib.Path(__file__).resolve().parent
NAMES = {1: "WM", 2: "GM", 3: "CSF", 5: "Scalp", 7: "Compact_bone", 8: "Spongy_bone", 12: "Fat"}
BEFORE_NODES = b"$MeshFormat\n2.2 1 8\n\1\0\0\0\n$EndMeshFormat\n$Nodes\n"  # SimNIBS reads no other section here


def head(extra=0):
    """Returns shells of tissues, the outer ones first in the file of names; a ball of fat touches scalp and bone."""
    x, y, z = (np.mgrid[:44, :52, :48] - np.array([21.5, 25.5, 23.5])[:, None, None, None])
    distance = np.sqrt(x**2 + (y / 1.2)**2 + (z / 1.1)**2)
    image = np.zeros(x.shape, np.uint16)
    for radius, tissue in ((20, 5), (17, 7), (15, 8), (13, 7), (11, 3), (9, 2), (6, 1)):
        image[distance < radius] = tissue
    image[(x - 18)**2 + y**2 + z**2 < 16] = 12 + extra
    return image


class HeadMesh(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name) / "head.msh"
        process = cls.run_example(cls.path, head(), folder.name)
        if process.returncode != 0:
            raise AssertionError(process.stderr)
        cls.read()

    @classmethod
    def run_example(cls, path, image, folder):
        affine = np.diag([-4.0, 4, 4, 1])
        nibabel.save(nibabel.Nifti1Image(image, affine), pathlib.Path(folder) / "head.nii")
        names = pathlib.Path(folder) / "names.txt"
        names.write_text("".join(f"{value} {name}\n" for value, name in NAMES.items()))
        return subprocess.run([sys.executable, "-W", "error", HERE / "head_mesh.py", f"{folder}/head.nii", path,
                               "--radius", "14", "--names", names], capture_output=True, text=True, check=False)

    @classmethod
    def read(cls):
        """Reads the file in the steps of simnibs.mesh_io.read_msh."""
        with open(cls.path, "rb") as file:
            assert file.read(len(BEFORE_NODES)) == BEFORE_NODES
            nodes = np.fromfile(file, [("number", "<i4"), ("place", "<f8", 3)], int(file.readline()))
            assert file.read(len(b"\n$EndNodes\n$Elements\n")) == b"\n$EndNodes\n$Elements\n"
            count, blocks = int(file.readline()), {}
            while sum(map(len, blocks.values())) < count:
                kind, size, num_tags = np.fromfile(file, "<i4", 3)
                assert num_tags == 2 and kind not in blocks
                blocks[kind] = np.fromfile(file, "<i4", size * (7 if kind == 4 else 6)).reshape(size, -1)
            assert file.read() == b"\n$EndElements\n"
        cls.nodes, cls.blocks, cls.triangles, cls.cells = nodes, blocks, blocks[2], blocks[4]

    def test_numbers_count_from_one(self):
        np.testing.assert_array_equal(self.nodes["number"], np.arange(1, len(self.nodes) + 1))
        numbers = np.concatenate([block[:, 0] for block in self.blocks.values()])
        np.testing.assert_array_equal(numbers, np.arange(1, len(numbers) + 1))

    def test_elements_are_triangles_and_tetrahedra_with_two_equal_tags(self):
        self.assertEqual(set(self.blocks), {2, 4})
        for block in self.blocks.values():
            np.testing.assert_array_equal(block[:, 1], block[:, 2])
        self.assertEqual(set(self.cells[:, 1]), set(NAMES))
        corners = self.nodes["place"][self.cells[:, 3:] - 1]
        self.assertGreater(np.linalg.det(corners[:, 1:] - corners[:, :1]).min(), 0)

    def test_each_facet_is_a_triangle_of_its_first_tissue_with_the_normal_outwards(self):
        """Derives the triangles from the tetrahedra alone, by SimNIBS's order of tissues."""
        rank = {tissue: place for place, tissue in enumerate((1, 2, 9, 3, 4, 8, 7, 6, 10, 5, 12))}
        sides = {}
        for cell in self.cells:
            for corner in range(3, 7):
                facet = tuple(sorted(np.delete(cell[3:], corner - 3)))
                sides.setdefault(facet, []).append((rank[cell[1]], cell[1], cell[corner]))
        expected = {facet: min(cells) for facet, cells in sides.items()
                    if len(cells) == 1 or cells[0][1] != cells[1][1]}
        found = {tuple(sorted(triangle[3:])): triangle for triangle in self.triangles}
        self.assertEqual(len(found), len(self.triangles))
        self.assertEqual(found.keys(), expected.keys())
        place = self.nodes["place"]
        for facet, (_, tissue, opposite) in expected.items():
            triangle = found[facet]
            self.assertEqual(triangle[1], 1000 + tissue)
            a, b, c = place[triangle[3:] - 1]
            self.assertLess(np.dot(np.cross(b - a, c - a), place[opposite - 1] - a), 0)

    def test_coordinates_are_ras(self):
        fat = self.nodes["place"][self.cells[self.cells[:, 1] == 12][:, 3:] - 1].mean(axis=(0, 1))
        self.assertLess(np.abs(fat - [-39.5 * 4, 25.5 * 4, 23.5 * 4]).max(), 6)

    @unittest.skipIf(gmsh is None, "needs gmsh: scripts/setup peers")
    def test_gmsh_reads_groups_and_names(self):
        gmsh.initialize()
        self.addCleanup(gmsh.finalize)
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(self.path))
        groups = {group: gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups()}
        expected = {(3, tissue): name for tissue, name in NAMES.items()}
        expected |= {(2, int(tag)): NAMES[tag - 1000] for tag in set(self.triangles[:, 1])}
        self.assertEqual(groups, expected)
        for (dimension, tag), _ in groups.items():
            block = self.blocks[4 if dimension == 3 else 2]
            _, numbers, _ = gmsh.model.mesh.getElements(dimension, tag)
            np.testing.assert_array_equal(np.sort(numbers[0]), block[block[:, 1] == tag][:, 0])

    def test_other_labels_are_refused_and_nothing_is_written(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "refused.msh"
            process = self.run_example(path, head(extra=1000), folder)
            self.assertEqual(process.returncode, 1)
            self.assertRegex(process.stderr, r"refused.msh: tissues of SimNIBS have tags from 1 to 999.*1012\n$")
            self.assertEqual(list(pathlib.Path(folder).glob("refused*")), [])


if __name__ == "__main__":
    unittest.main()
