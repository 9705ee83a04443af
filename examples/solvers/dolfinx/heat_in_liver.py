"""Heat in the liver with DOLFINx: a heated ball in it, conduction everywhere, blood that carries heat away.

usage: heat_in_liver.py FOLDER [IMAGE]    (packages python3-dolfinx, python3-h5py, python3-matplotlib)
"""
import pathlib
import sys

import h5py
import numpy as np
import ufl
from dolfinx import fem, io
from mpi4py import MPI
from petsc4py import PETSc

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
import from_image  # noqa: E402

CONDUCTIVITY = 5e-4        # W/(mm K), of soft tissue
PERFUSION = 2e-6           # W/(mm^3 K), lower than in life: the cells here are larger than the reach of blood
SOURCE, RADIUS = 5e-5, 25  # W/mm^3 in a ball of this radius (mm) around the centre of the liver


def read(path):
    with io.XDMFFile(MPI.COMM_WORLD, str(path), "r") as file:
        mesh = file.read_mesh(name="mesh")
        labels = file.read_meshtags(mesh, name="mesh")
        mesh.topology.create_connectivity(2, 3)
        pairs = file.read_meshtags(mesh, name="facets")
    with h5py.File(path.with_suffix(".h5")) as arrays:
        table = arrays["labels"]
        label_names = {int(value): name.decode() for value, name in zip(table["value"][:], table["name"][:])}
        pair_names = {tag: name.decode() for tag, name in enumerate(arrays["pairs/name"][:], start=1)}
    return mesh, labels, pairs, label_names, pair_names


def main():
    parsed = from_image.arguments(__doc__.splitlines()[0])
    path, record = from_image.make_mesh(parsed, "abdomen.xdmf")
    mesh, labels, pairs, label_names, pair_names = read(path)
    dx = ufl.Measure("dx", domain=mesh, subdomain_data=labels)
    one = fem.Constant(mesh, PETSc.ScalarType(1))

    def integral(form):
        return fem.assemble_scalar(fem.form(form))

    from_image.check(record, mesh.topology.index_map(3).size_global,
                     {label_names[value]: integral(one * dx(int(value))) for value in np.unique(labels.values)},
                     {pair_names[tag]: count for tag, count in zip(*np.unique(pairs.values, return_counts=True))})

    x = ufl.SpatialCoordinate(mesh)
    liver = dx(from_image.LIVER)
    centre = [integral(x[k] * liver) / integral(one * liver) for k in range(3)]
    is_heated = ufl.conditional(ufl.lt(sum((x[k] - centre[k]) ** 2 for k in range(3)), RADIUS ** 2), 1.0, 0.0)
    space = fem.FunctionSpace(mesh, ("CG", 1))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)  # K above the blood's temperature
    outer = np.concatenate([pairs.find(tag) for tag, name in pair_names.items() if name.endswith("|outside")])
    skin = fem.dirichletbc(PETSc.ScalarType(0), fem.locate_dofs_topological(space, 2, outer), space)
    heat = CONDUCTIVITY * ufl.inner(ufl.grad(u), ufl.grad(v)) * dx + PERFUSION * u * v * dx
    solution = fem.petsc.LinearProblem(heat, SOURCE * is_heated * v * liver, bcs=[skin],
                                       petsc_options={"ksp_type": "cg", "pc_type": "jacobi"}).solve()
    rise = solution.x.array
    assert 0 < rise.max() < SOURCE / PERFUSION, "no point is hotter than without conduction"
    points = space.tabulate_dof_coordinates()
    cells = space.dofmap.list.array.reshape(-1, 4)
    from_image.draw_cut(points, cells, rise, "K above blood", parsed.folder / "heat_in_liver.png")
    print(f"{record['cells']} cells, at most {rise.max():.1f} K above blood")


main()
