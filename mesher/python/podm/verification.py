"""Verification of meshes by podm-verify, a separate process that reads only their files."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import Error

if TYPE_CHECKING:
    from ._podm import MeshInMemory
    from .result import Mesh

_CLAIM_FAILED = 1


@dataclasses.dataclass(frozen=True)
class Verification:
    """The report of podm-verify on a mesh."""

    verdicts: dict[str, str]
    """By claim: "pass", "fail", or why it is not decided."""
    details: dict[str, Any]
    """The whole report, as `podm-verify --json` writes it, with the places of what fails."""
    text: str
    """The report for people."""

    @property
    def holds(self) -> bool:
        """True if every claim passes."""
        return bool(self.verdicts) and set(self.verdicts.values()) == {"pass"}

    def __bool__(self) -> bool:
        return self.holds

    def __str__(self) -> str:
        return self.text


def verify(mesh: Mesh, made: MeshInMemory, fidelity: bool) -> Verification:
    program = _verifier()
    with tempfile.TemporaryDirectory(prefix="podm-verify-") as folder:
        path = os.path.join(folder, "mesh.vtu")
        mesh.save(path)
        claims = made.claims(fidelity, lambda: _write_image(made, os.path.join(folder, "image.nrrd")))
        process = subprocess.run([program, path, "--json", "-", *claims], capture_output=True, encoding="utf-8",
                                 errors="replace", check=False)
    if process.returncode not in (0, _CLAIM_FAILED):
        raise Error(f"{program}: {process.stderr.strip() or f'it ended with {process.returncode}'}")
    details = json.loads(process.stdout)
    verdicts = {claim: result["verdict"] for claim, result in details["claims"].items()}
    return Verification(verdicts, details, process.stderr)


def _verifier() -> str:
    own = pathlib.Path(__file__).parent / "bin" / "podm-verify"
    program = str(own) if own.exists() else shutil.which("podm-verify")
    if program is None:
        raise Error(f"podm-verify: it is neither in {own.parent} nor on the PATH")
    return program


def _write_image(made: MeshInMemory, path: str) -> bytes:
    """Writes the image as NRRD, whose header holds the affine to the last bit. Returns the file's name."""
    values = np.array([value for value, _ in made.labels], dtype="<u4")
    rows = np.reshape(made.voxel_to_ras, (3, 4))
    vectors = ["(" + ",".join(map(repr, column.tolist())) + ")" for column in rows.T]
    header = ("NRRD0004\ntype: uint32\ndimension: 3\nspace: right-anterior-superior\n"
              f"sizes: {' '.join(map(str, made.image_size))}\nspace directions: {' '.join(vectors[:3])}\n"
              f"kinds: domain domain domain\nendian: little\nencoding: raw\nspace origin: {vectors[3]}\n\n")
    slices = made.voxels.reshape(made.image_size[2], -1)
    with open(path, "wb") as file:
        file.write(header.encode())
        for voxels in slices:
            file.write(values[voxels].tobytes())
    return os.fsencode(path)
