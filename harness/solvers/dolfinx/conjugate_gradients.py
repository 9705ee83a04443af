"""Solves systems by PETSc's conjugate gradients and estimates the eigenvalues of the matrix."""
import time
from dataclasses import dataclass

from petsc4py import PETSc

RELATIVE_TOLERANCE = 1e-8  # of the residual, relative to that of the solution 0
MAX_ITERATIONS = 50_000
# The names in records, and PETSc's names: the diagonal, and smoothed aggregation.
PRECONDITIONERS = {"jacobi": PETSc.PC.Type.JACOBI, "amg": PETSc.PC.Type.GAMG}


class SolverError(Exception):
    """A system that was not solved."""


@dataclass(frozen=True)
class Measured:
    """The cost of a solution. The eigenvalues are those of the preconditioned matrix; the Lanczos process, which
    conjugate gradients carry out, estimates them. `setup_s`: setup of the preconditioner; `seconds`: iterations."""

    iterations: int
    smallest_eigenvalue: float
    largest_eigenvalue: float
    setup_s: float
    seconds: float


def solve(system, preconditioner):
    """Returns the solution, a vector of PETSc, and its cost. Raises SolverError."""
    krylov = PETSc.KSP().create(system.matrix.comm)
    krylov.setOperators(system.matrix)
    krylov.setType(PETSc.KSP.Type.CG)
    krylov.getPC().setType(PRECONDITIONERS[preconditioner])
    krylov.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    krylov.setTolerances(rtol=RELATIVE_TOLERANCE, atol=0, max_it=MAX_ITERATIONS)
    krylov.setComputeSingularValues(True)
    krylov.setFromOptions()  # sets the remaining defaults of GAMG
    solution = system.right_side.duplicate()
    start = time.perf_counter()
    krylov.setUp()
    ready = time.perf_counter()
    krylov.solve(system.right_side, solution)
    end = time.perf_counter()
    if krylov.getConvergedReason() <= 0:
        raise SolverError(f"conjugate gradients with {preconditioner} ended after {krylov.getIterationNumber()} "
                          f"iterations for PETSc's reason {krylov.getConvergedReason()}")
    largest, smallest = krylov.computeExtremeSingularValues()
    measured = Measured(krylov.getIterationNumber(), smallest, largest, ready - start, end - ready)
    krylov.destroy()
    return solution, measured
