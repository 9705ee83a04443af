"""Tetrahedral meshes with guarantees from segmented 3-D images.

The input is a segmentation: a numpy array, a nibabel image or a file name. The output is a mesh for finite elements::

    import nibabel, podm

    mesh = podm.mesh(nibabel.load("seg.nii.gz"), radius=4, radius_of={"liver": 2}, names={1: "liver"})
    mesh.points, mesh.cells, mesh.labels        # numpy arrays; mm, positions of points, values of the image
    mesh.save("mesh.vtu")
    print(mesh.verify())                        # podm-verify proves what the mesh promises

Every mesh of a finished run keeps the bounds of the program `podm`: cells have a radius-edge ratio below 1.93 and are
Delaunay; boundary and interface facets have angles above 30 degrees and vertices on the surface between the labels.

`plan` predicts the cost of a mesh and the parts that it loses. `mesh` runs the mesher and returns a `Mesh`.
`Verification` is the report of the proofs. The exceptions are `Error`, `InternalError` and `Interrupted`. A callback
gets a `Progress`.
"""

from .processor import check_processor

check_processor()  # before an instruction of the extension module runs

from ._podm import Progress, __version__
from .errors import Error, InternalError, Interrupted
from .meshing import mesh, plan
from .result import Mesh
from .verification import Verification

__all__ = ["Error", "InternalError", "Interrupted", "Mesh", "Progress", "Verification", "__version__", "mesh",
           "plan"]

for _public in (Error, InternalError, Interrupted, Mesh, Progress, Verification, mesh, plan):
    _public.__module__ = "podm"
