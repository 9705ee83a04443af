"""Makes a head mesh for SimNIBS 4 from a segmentation with SimNIBS's tissue labels.

usage: head_mesh.py IMAGE HEAD.msh [--radius MM] [--smooth MM] [--names FILE]    (packages podm, python3-meshio)

SimNIBS reads Gmsh 2.2, binary, and refuses a file that has a list of names between head and nodes. Names go where
SimNIBS's own go, to HEAD.msh.opt, which Gmsh reads with the mesh.

Tetrahedra have the tag of their tissue (1 to 999), triangles 1000 + the tag of the tissue whose surface they are. Each
facet is one triangle. Where two tissues meet, it belongs to the first in SimNIBS's order, and its normal points out of
this tissue.
"""

import argparse
import pathlib
import sys

import meshio
import numpy as np

import podm

# SimNIBS's reconstruct_unique_surface: white and gray matter, blood, CSF, bone, spongy and compact bone, eyes, muscle,
# scalp. Other tissues follow by their tags.
ORDER = (1, 2, 9, 3, 4, 8, 7, 6, 10, 5)
LARGEST_TISSUE = 999


def surfaces(mesh):
    """Returns the triangles, and the tissue to which each belongs."""
    tissues = np.unique(mesh.labels).tolist()
    by_rank = sorted(tissues, key=lambda tissue: (ORDER.index(tissue) if tissue in ORDER else len(ORDER), tissue))
    by_rank.append(mesh.background)
    values, position = np.unique(mesh.facet_labels, return_inverse=True)
    rank = np.array([by_rank.index(value) for value in values])[position].reshape(-1, 2)
    is_first = rank[:, 0] < rank[:, 1]  # the normals of podm point out of the second label
    triangles = np.where(is_first[:, None], mesh.facets[:, ::-1], mesh.facets)
    return triangles, np.where(is_first, *mesh.facet_labels.T)


def save(mesh, path):
    """Writes the mesh for SimNIBS: PATH, and the names of tissues in PATH.opt."""
    tissues = np.unique(mesh.labels)
    if not 1 <= tissues[0] <= tissues[-1] <= LARGEST_TISSUE:
        raise podm.Error(f"{path}: tissues of SimNIBS have tags from 1 to {LARGEST_TISSUE}, and this mesh has the "
                         f"labels {tissues[0]} to {tissues[-1]}")
    triangles, owner = surfaces(mesh)
    tags = [1000 + owner, mesh.labels]
    meshio.write(path, meshio.Mesh(mesh.points, [("triangle", triangles), ("tetra", mesh.cells)], cell_data={
        "gmsh:physical": tags, "gmsh:geometrical": tags}), file_format="gmsh22", binary=True)
    groups = [("Volume", tissue, tissue) for tissue in tissues]
    groups += [("Surface", 1000 + tissue, tissue) for tissue in np.unique(owner)]
    pathlib.Path(f"{path}.opt").write_text("".join(
        f'Physical {kind} ("{mesh.names[tissue]}", {tag}) = {{ {tag} }};\n' for kind, tag, tissue in groups))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("image", help="segmentation with SimNIBS's tissues: 1 white matter, 2 gray matter, ...")
    parser.add_argument("output", help="the .msh file")
    parser.add_argument("--radius", type=float, help="largest circumradius of a cell, mm")
    parser.add_argument("--smooth", type=float, help="width by which surfaces are smoothed, mm")
    parser.add_argument("--names", help="file of names of labels, as podm mesh --label-names")
    parsed = parser.parse_args()
    try:
        mesh = podm.mesh(parsed.image, radius=parsed.radius, smooth=parsed.smooth, names=parsed.names)
        save(mesh, parsed.output)
    except podm.Error as error:
        sys.exit(f"head_mesh.py: {error}")
    print(mesh, file=sys.stderr)


if __name__ == "__main__":
    main()
