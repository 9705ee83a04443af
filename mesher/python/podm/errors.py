"""The exceptions of podm."""

from __future__ import annotations

import typing

if typing.TYPE_CHECKING:
    from .result import Mesh


class Error(ValueError):
    """An image, an argument or a file is wrong; the text names it and the expected value."""


class InternalError(RuntimeError):
    """The mesher itself is wrong: an invariant is broken. The caller never causes it."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended the run while there was a mesh to keep. A caller that wants the mesh catches this exception::

        try:
            mesh = podm.mesh(labels, radius=0.5)
        except podm.Interrupted as interrupted:
            mesh = interrupted.mesh
    """

    mesh: Mesh
    """The mesh so far: valid, but coarser than requested where it was not yet refined."""

    def __init__(self, mesh: Mesh) -> None:
        super().__init__(f"meshing was interrupted: {mesh!r}")
        self.mesh = mesh
