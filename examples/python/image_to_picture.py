"""Makes a mesh from a segmentation, verifies it and draws it, cell by cell: as a script, or in an editor for # %%.

Needs the package podm (`make python`, or pip install --no-build-isolation ./mesher/python) and Debian's
python3-matplotlib and python3-vtk9.
"""

# %% The input: here a phantom; the name of a segmentation, an array or a nibabel image also works.
import matplotlib
import numpy as np
import vtk
from matplotlib.collections import PolyCollection
from vtk.util.numpy_support import vtk_to_numpy

import podm

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of what draws)

IMAGE = "phantom:abdomen@64"

# %% Makes a mesh: cells up to 20 mm, in the liver up to 8 mm, surfaces sampled every 6 mm.
mesh = podm.mesh(IMAGE, radius=20, radius_of={"liver": 8}, delta=6, optimize=True, threads=1)
print(repr(mesh))
print(mesh)

# %% Proves the mesh: a program that knows only its file checks all its guarantees.
report = mesh.verify()
print(report)
assert report.holds

# %% Saves the mesh for ParaView or a solver.
mesh.save("mesh.vtu")

# %% Draws the quality of the cells of each label.
colours = plt.get_cmap("tab20")
BESIDE = {"loc": "center left", "bbox_to_anchor": (1, 0.5), "ncols": 2, "fontsize": "small"}
quality = mesh.quality()["min_dihedral_deg"]
names = list(mesh.names.items())
figure, axes = plt.subplots(figsize=(8, 5))
axes.hist([quality[mesh.labels == value] for value, _ in names], bins=np.arange(0, 75, 5), stacked=True,
          color=colours(np.arange(len(names)) % 20), label=[name for _, name in names])
axes.set(xlabel="least dihedral angle of the cell, degrees", ylabel="cells")
axes.legend(**BESIDE)
figure.savefig("quality.png", dpi=120, bbox_inches="tight")

# %% Cuts the mesh by a plane: each polygon is a cell, coloured by label.
center = (mesh.points.min(axis=0) + mesh.points.max(axis=0)) / 2
plane = vtk.vtkPlane()
plane.SetOrigin(center)
plane.SetNormal(0, 0, 1)
cutter = vtk.vtkCutter()
cutter.SetCutFunction(plane)
cutter.GenerateTrianglesOff()
cutter.SetInputData(mesh.to_vtk())
cutter.Update()
cut = cutter.GetOutput()
corners = vtk_to_numpy(cut.GetPoints().GetData())[:, :2]
ends = vtk_to_numpy(cut.GetPolys().GetOffsetsArray())
polygons = np.split(corners[vtk_to_numpy(cut.GetPolys().GetConnectivityArray())], ends[1:-1])
ranks = np.searchsorted(sorted(mesh.names), vtk_to_numpy(cut.GetCellData().GetArray("label")))

figure, axes = plt.subplots(figsize=(9, 7))
axes.add_collection(PolyCollection(polygons, facecolors=colours(ranks % 20), edgecolors="black", linewidths=0.3))
for rank, value in enumerate(sorted(mesh.names)):
    axes.scatter([], [], color=colours(rank % 20), label=mesh.names[value])
axes.set(xlabel="x, mm", ylabel="y, mm", title=f"{len(mesh.cells)} cells, cut at z = {center[2]:.0f} mm")
axes.set_aspect("equal")
axes.autoscale()
axes.legend(**BESIDE)
figure.savefig("mesh.png", dpi=120, bbox_inches="tight")
