"""Heat in the liver with SfePy: a warm liver, conduction everywhere, skin at the temperature of the room.

usage: heat_in_liver.py FOLDER [IMAGE]    (packages python3-sfepy, python3-meshio, python3-matplotlib)
"""
import pathlib
import sys

import meshio
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
import from_image  # noqa: E402

from sfepy.discrete import Equation, Equations, FieldVariable, Integral, Material, Problem  # noqa: E402
from sfepy.discrete.conditions import Conditions, EssentialBC  # noqa: E402
from sfepy.discrete.fem import FEDomain, Field, Mesh  # noqa: E402
from sfepy.solvers.ls import ScipyDirect  # noqa: E402
from sfepy.solvers.nls import Newton  # noqa: E402
from sfepy.terms import Term  # noqa: E402

CONDUCTIVITY, PERFUSION, SOURCE = 5e-4, 2e-6, 5e-6  # W/(mm K), W/(mm^3 K), W/mm^3 in the whole liver


def read_mesh(path):
    """Reads a VTK file by meshio, because SfePy's own reader ignores its labels."""
    read = meshio.read(path)
    return Mesh.from_data("abdomen", read.points, None, [read.cells[0].data], [read.cell_data["label"][0].astype(int)],
                          ["3_4"])


def sizes_of(domain, regions, names):
    """Returns volumes by label name, and numbers of facets by pair name, from SfePy's regions."""
    volumes = {names[value]: domain.cmesh.get_volumes(3)[region.cells].sum() for value, region in regions.items()}
    facets = {}
    outer = domain.create_region("outer", "vertices of surface", "facet")
    for b in sorted(regions):
        for a in [0, *(value for value in sorted(regions) if value < b)]:
            other = outer if a == 0 else regions[a]
            count = len(np.intersect1d(regions[b].facets, other.facets))
            if count > 0:
                facets[f"{names[b]}|{names[a]}"] = count
    return volumes, facets


def main():
    parsed = from_image.arguments(__doc__.splitlines()[0])
    path, record = from_image.make_mesh(parsed, "abdomen.vtk")
    mesh = read_mesh(path)
    domain = FEDomain("abdomen", mesh)
    omega = domain.create_region("all", "all")
    regions = {value: domain.create_region(f"label{value}", f"cells of group {value}")
               for value in np.unique(mesh.cmesh.cell_groups)}
    from_image.check(record, mesh.n_el, *sizes_of(domain, regions, from_image.names_of(record)))

    integral = Integral("i", order=2)
    field = Field.from_args("temperature", np.float64, 1, omega, approx_order=1)
    u = FieldVariable("u", "unknown", field)  # K above the blood's temperature
    v = FieldVariable("v", "test", field, primary_var_name="u")
    tissue, source = Material("tissue", k=CONDUCTIVITY, w=PERFUSION), Material("source", q=SOURCE)
    heat = Equation("heat", Term.new("dw_laplace(tissue.k, v, u)", integral, omega, tissue=tissue, v=v, u=u) +
                    Term.new("dw_dot(tissue.w, v, u)", integral, omega, tissue=tissue, v=v, u=u) -
                    Term.new("dw_integrate(source.q, v)", integral, regions[from_image.LIVER], source=source, v=v))
    skin = EssentialBC("skin", domain.create_region("skin", "vertices of surface", "facet"), {"u.0": 0.0})
    problem = Problem("heat", equations=Equations([heat]))
    problem.set_bcs(ebcs=Conditions([skin]))
    problem.set_solver(Newton({}, lin_solver=ScipyDirect({})))
    problem.solve(save_results=False)
    rise = u()
    assert 0 < rise.max() < SOURCE / PERFUSION, "no point is hotter than without conduction"
    from_image.draw_cut(mesh.coors, mesh.get_conn("3_4"), rise, "K above blood", parsed.folder / "heat_in_liver.png")
    print(f"{record['cells']} cells, at most {rise.max():.1f} K above blood")


main()
