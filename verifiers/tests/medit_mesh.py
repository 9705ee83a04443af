"""A tetrahedral mesh as Medit text. The tests read, change and write it without the project's own code."""

import copy

import numpy as np


class MeditMesh:
    """vertices (n,3) float64, cells (m,5) and facets (k,4) int: 0-based vertices, then the reference; comments."""

    def __init__(self, vertices=(), cells=(), facets=(), comments=()):
        self.vertices = np.array(vertices, dtype=np.float64).reshape(-1, 3)
        self.cells = np.array(cells, dtype=np.int64).reshape(-1, 5)
        self.facets = np.array(facets, dtype=np.int64).reshape(-1, 4)
        self.comments = list(comments)

    def copy(self):
        return copy.deepcopy(self)

    def write(self, path, digits=17):
        with open(path, "w", encoding="utf-8") as file:
            file.write("MeshVersionFormatted 2\n" + "".join(self.comments) + "Dimension 3\n")
            file.write(f"Vertices\n{len(self.vertices)}\n")
            for p in self.vertices:
                file.write(" ".join(f"{x:.{digits}g}" for x in p) + " 0\n")
            for name, rows in (("Triangles", self.facets), ("Tetrahedra", self.cells)):
                file.write(f"{name}\n{len(rows)}\n")
                for row in rows:
                    file.write(" ".join(str(v + 1) for v in row[:-1]) + f" {row[-1]}\n")
            file.write("End\n")


def read_medit(path):
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines(keepends=True)
    words = " ".join(line for line in lines if not line.startswith("#")).split()

    def section(name, width, convert):
        at = words.index(name)
        count = int(words[at + 1])
        flat = [convert(word) for word in words[at + 2:at + 2 + count * width]]
        return np.array(flat).reshape(count, width)

    mesh = MeditMesh(section("Vertices", 4, float)[:, :3], section("Tetrahedra", 5, int),
                     section("Triangles", 4, int), [line for line in lines if line.startswith("#")])
    mesh.cells[:, :4] -= 1
    mesh.facets[:, :3] -= 1
    return mesh


def signed_volumes(mesh):
    a, b, c, d = (mesh.vertices[mesh.cells[:, k]] for k in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def kuhn_cubes(nx, ny, nz):
    """Returns unit cubes of six positive cells each; all vertices of a cube are cospherical."""
    def vertex(i, j, k):
        return i + (nx + 1) * (j + (ny + 1) * k)
    points = [(i, j, k) for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)]
    steps = np.eye(3, dtype=int)
    cells = []
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                for order in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)):
                    corner = np.array([i, j, k])
                    path = [vertex(*corner)]
                    for axis in order:
                        corner = corner + steps[axis]
                        path.append(vertex(*corner))
                    cells.append([*path, 1])
    mesh = MeditMesh(points, cells)
    turned = signed_volumes(mesh) < 0
    mesh.cells[turned, 2], mesh.cells[turned, 3] = mesh.cells[turned, 3].copy(), mesh.cells[turned, 2].copy()
    return mesh
