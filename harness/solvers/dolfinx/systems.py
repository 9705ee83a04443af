"""Linear systems of P1 finite elements on tetrahedra, with given values on the whole outer boundary."""
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem, mesh as dolfinx_mesh
from dolfinx.fem import petsc
from mpi4py import MPI
from petsc4py import PETSc

YOUNGS_MODULUS, POISSONS_RATIO = 1.0, 0.3


@dataclass(frozen=True)
class System:
    """A linear system. In `matrix` the rows and columns of known values are those of the identity; the matrix is
    therefore symmetric and positive definite. `unknowns`: the number of values that are not given."""

    space: fem.FunctionSpace
    matrix: PETSc.Mat
    right_side: PETSc.Vec
    unknowns: int


def domain_of(points, cells):
    """Returns a mesh of DOLFINx, which numbers cells and points anew."""
    element = ufl.VectorElement("Lagrange", ufl.tetrahedron, 1)
    return dolfinx_mesh.create_mesh(MPI.COMM_SELF, cells, points, ufl.Mesh(element))


def poisson(domain, boundary_value=lambda x: np.zeros(x.shape[1]), source=1.0):
    """Returns the system of -div grad u = source inside and u = boundary_value(x), of shape (n,) for x of (3, n), on
    the boundary."""
    space = fem.FunctionSpace(domain, ("Lagrange", 1))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    form = ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx
    load = fem.Constant(domain, PETSc.ScalarType(source)) * v * ufl.dx
    return _system(space, form, load, boundary_value)


def elasticity(domain, boundary_value=np.zeros_like, force=(0.0, 0.0, -1.0)):
    """Returns the system of an isotropic body under a force per volume. Displacements boundary_value(x), of the shape
    of x, (3, n), are given on its boundary. Multigrid needs the near null space, which are the rigid motions."""
    space = fem.VectorFunctionSpace(domain, ("Lagrange", 1))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    mu = YOUNGS_MODULUS / (2 * (1 + POISSONS_RATIO))
    lame = YOUNGS_MODULUS * POISSONS_RATIO / ((1 + POISSONS_RATIO) * (1 - 2 * POISSONS_RATIO))
    strain = ufl.sym(ufl.grad(u))
    stress = 2 * mu * strain + lame * ufl.tr(strain) * ufl.Identity(3)
    form = ufl.inner(stress, ufl.sym(ufl.grad(v))) * ufl.dx
    load = ufl.inner(fem.Constant(domain, PETSc.ScalarType(force)), v) * ufl.dx
    system = _system(space, form, load, boundary_value)
    system.matrix.setNearNullSpace(_rigid_motions(space, system.right_side))
    return system


def _system(space, form, load, boundary_value):
    domain = space.mesh
    domain.topology.create_connectivity(2, 3)
    facets = dolfinx_mesh.exterior_facet_indices(domain.topology)
    known = fem.locate_dofs_topological(space, 2, facets)
    given = fem.Function(space)
    given.interpolate(boundary_value)
    boundary = fem.dirichletbc(given, known)
    bilinear, linear = fem.form(form), fem.form(load)
    matrix = petsc.assemble_matrix(bilinear, bcs=[boundary])
    matrix.assemble()
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    right_side = petsc.assemble_vector(linear)
    petsc.apply_lifting(right_side, [bilinear], [[boundary]])
    petsc.set_bc(right_side, [boundary])
    num_nodes = space.dofmap.index_map.size_local
    return System(space, matrix, right_side, (num_nodes - len(known)) * space.dofmap.index_map_bs)


def _rigid_motions(space, like):
    """Returns three translations and three rotations, orthonormal."""
    x, y, z = space.tabulate_dof_coordinates().T
    zero, one = np.zeros_like(x), np.ones_like(x)
    motions = [(one, zero, zero), (zero, one, zero), (zero, zero, one), (-y, x, zero), (z, zero, -x), (zero, -z, y)]
    basis, _ = np.linalg.qr(np.stack([np.stack(motion, axis=1).ravel() for motion in motions], axis=1))
    vectors = []
    for column in basis.T:
        vector = like.duplicate()
        vector.setArray(column)
        vectors.append(vector)
    return PETSc.NullSpace().create(vectors=vectors, comm=like.comm)
