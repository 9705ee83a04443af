"""What podm raises."""

from __future__ import annotations

import typing

if typing.TYPE_CHECKING:
    from .result import Mesh


class Error(ValueError):
    """An image, an argument or a file is at fault; the text says which, and what was expected."""


class InternalError(RuntimeError):
    """The mesher itself is at fault: a broken invariant, never the caller's doing."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C came while there was a mesh to keep. Whoever wants it catches this exception::

        try:
            mesh = podm.mesh(labels, radius=0.5)
        except podm.Interrupted as interrupted:
            mesh = interrupted.mesh
    """

    mesh: Mesh
    """The mesh so far: valid, but coarser than asked for where refinement had not been yet."""

    def __init__(self, mesh: Mesh) -> None:
        super().__init__(f"meshing was interrupted: {mesh!r}")
        self.mesh = mesh
