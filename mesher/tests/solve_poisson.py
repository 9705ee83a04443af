"""Solves a Poisson equation on a mesh of labels with DOLFINx, and writes the results as JSON.

usage: mpirun -n RANKS python3 solve_poisson.py MESH.xdmf TAGS RESULT.json

-div grad u = 1 inside, u = 0 on the facets with one of the tags, such as 1,2,4.
"""
import json
import pathlib
import sys

import numpy as np
import ufl
from dolfinx import fem, io
from mpi4py import MPI
from petsc4py import PETSc

OUTSIDE_TAGS = [int(tag) for tag in sys.argv[2].split(",")]


def read(path):
    """Returns the mesh, the labels of its cells, and the tags of its facets."""
    with io.XDMFFile(MPI.COMM_WORLD, path, "r") as file:
        mesh = file.read_mesh(name="mesh")
        labels = file.read_meshtags(mesh, name="mesh")
        mesh.topology.create_connectivity(2, 3)
        tags = file.read_meshtags(mesh, name="facets")
    return mesh, labels, tags


def integral(mesh, form):
    return mesh.comm.allreduce(fem.assemble_scalar(fem.form(form)), op=MPI.SUM)


def main():
    mesh, labels, tags = read(sys.argv[1])
    ds = ufl.Measure("ds", domain=mesh)
    dx = ufl.Measure("dx", domain=mesh, subdomain_data=labels)
    dS_of_tag = ufl.Measure("ds", domain=mesh, subdomain_data=tags)
    one = fem.Constant(mesh, PETSc.ScalarType(1))
    all_labels = sorted(set().union(*mesh.comm.allgather(set(labels.values.tolist()))))
    outer = np.concatenate([tags.find(tag) for tag in OUTSIDE_TAGS])

    space = fem.FunctionSpace(mesh, ("CG", 1))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    boundary = fem.dirichletbc(PETSc.ScalarType(0), fem.locate_dofs_topological(space, 2, outer), space)
    problem = fem.petsc.LinearProblem(ufl.inner(ufl.grad(u), ufl.grad(v)) * dx, one * v * dx, bcs=[boundary],
                                      petsc_options={"ksp_type": "cg", "pc_type": "jacobi", "ksp_rtol": 1e-10})
    solution = problem.solve()
    values = solution.x.array[:space.dofmap.index_map.size_local]
    found = {"ranks": mesh.comm.size,
             "cells": mesh.topology.index_map(3).size_global,
             "vertices": mesh.geometry.index_map().size_global,
             "volumes": {str(label): integral(mesh, one * dx(label)) for label in all_labels},
             "outer_area": integral(mesh, one * ds),
             "outer_area_by_tags": sum(integral(mesh, one * dS_of_tag(tag)) for tag in OUTSIDE_TAGS),
             "minimum": mesh.comm.allreduce(values.min(initial=0), op=MPI.MIN),
             "maximum": mesh.comm.allreduce(values.max(initial=0), op=MPI.MAX),
             "integral": integral(mesh, solution * dx),
             "energy": integral(mesh, ufl.inner(ufl.grad(solution), ufl.grad(solution)) * dx)}
    if mesh.comm.rank == 0:
        pathlib.Path(sys.argv[3]).write_text(json.dumps(found))


main()
