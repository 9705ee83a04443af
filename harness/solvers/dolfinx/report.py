"""Reports the cost of solving on a mesh in the form of the contract in ../README.md."""
import dataclasses

import dolfinx
from petsc4py import PETSc

from conjugate_gradients import PRECONDITIONERS, SolverError, solve
from systems import domain_of, elasticity, poisson

SYSTEMS = {"poisson": poisson, "elasticity": elasticity}


def version():
    petsc = ".".join(map(str, PETSc.Sys.getVersion()))
    return f"DOLFINx {dolfinx.__version__} (LGPL-3.0-or-later), PETSc {petsc} (BSD-2-Clause)"


def report_on(points, cells):
    """Returns a dictionary. Raises SolverError if a mesh has no inner vertex, or if a system is not solved."""
    domain = domain_of(points, cells)
    return {"solver": version(), **{name: _measured(name, make(domain)) for name, make in SYSTEMS.items()}}


def _measured(name, system):
    if system.unknowns == 0:
        raise SolverError("every vertex is on the boundary: nothing is unknown")
    made = {"unknowns": system.unknowns}
    for preconditioner in PRECONDITIONERS:
        try:
            _, measured = solve(system, preconditioner)
        except SolverError as error:
            raise SolverError(f"{name}: {error}") from None
        made[preconditioner] = dataclasses.asdict(measured)
    return made
