"""podm.mesh makes a mesh from an image; podm.plan predicts it."""

from __future__ import annotations

import json
import os
import re
import warnings
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from . import _podm
from .arguments import command_line
from .checks import expect, is_label_value, path_bytes, text_bytes
from .errors import Error, Interrupted
from .images import is_file, voxels_and_affine
from .result import Mesh

if TYPE_CHECKING:
    import numpy.typing as npt

    StrPath = str | os.PathLike[str]
    LabelValues = str | int | Iterable[int]


def mesh(labels: npt.ArrayLike | StrPath, *, affine: npt.ArrayLike | None = None,
         spacing: npt.ArrayLike | None = None, names: Mapping[int, str] | StrPath | None = None,
         keep: LabelValues | None = None, drop: LabelValues | None = None,
         merge: Mapping[str, LabelValues] | None = None, drop_islands: float | None = None,
         background: int | None = None, radius: float | None = None,
         radius_of: Mapping[str | int, float] | None = None, size_image: StrPath | None = None,
         size_near: Mapping[tuple[str | int, str | int], float | tuple[float, float]] | None = None,
         grade: float | None = None, delta: float | None = None, target_elements: int | None = None,
         target_tolerance: float | None = None, smooth: float | None = None, min_dihedral: float | None = None,
         optimize: bool = False, dihedral_bounds: tuple[float, float] | None = None,
         max_elements: int | None = None, max_seconds: float | None = None, max_memory_gib: float | None = None,
         space: str | None = None, algorithm: str | None = None, crossover: int | StrPath | None = None,
         nodes: int | None = None, cores_per_node: int | None = None, initial_ratio: float | None = None,
         initial_threads: int | None = None, leaf_size: float | None = None, threads: int | None = None,
         contention: str | None = None, begging: str | None = None, pin: str | None = None,
         oversubscribe: bool = False, topology: StrPath | None = None, cost_factor: str | None = None,
         executor: str | None = None, virtual_cost: str | None = None, seed: int | None = None,
         progress: Callable[[_podm.Progress], object] | None = None) -> Mesh:
    """Meshes a label image into tetrahedra.

    Only the image is required; the mesher chooses values that are None. Options have the names, meanings and defaults
    of `podm mesh`, below.

    labels
        The image. It is an array of shape (ni, nj, nk) of any integer type, in any memory order, with values 0 to
        2^32 - 1; or an image of nibabel; or the name of a NIfTI, NRRD, MetaImage or INR file, or phantom:NAME[@SIZE].
        An array is read, not copied; the mesher makes its own array of 2 bytes per voxel.
    affine
        The 4x4 matrix, as in nibabel, from voxel indices (i, j, k) to RAS coordinates in mm. Any invertible matrix is
        allowed. A matrix that shears changes angles: the bounds on shape then hold in the image's own axes.
    spacing
        The three distances between voxels, mm, in place of an affine; for arrays only. Voxel (0, 0, 0) is at the
        origin. Without affine and spacing the distances are 1 mm.
    names
        Names of labels, as {1: "liver"}; or a file of names, an ITK-SNAP table or lines "value name".
    size_image
        The name of a file. Write an array to a file first, e.g. with nibabel.
    size_near
        A dict from pairs of labels to mm, or to mm and a width, as {("liver", 0): 1, ("liver", "vein"): (0.5, 3)}.
    progress
        A function that the thread of the caller calls with a podm.Progress several times per second. If it raises an
        exception, the run ends and mesh() raises this exception.

    Other Python threads run meanwhile, and may mesh, too.

    Raises podm.Error, a ValueError, for a wrong image or option; MemoryError; and podm.Interrupted, a
    KeyboardInterrupt, if Ctrl-C ends the run early: its `mesh` is the current mesh, which is valid. A limit
    (max_elements, max_seconds) raises no exception: the current mesh is returned, and its `is_complete` is False.
    warnings.warn() reports the guarantees that a mesh misses, and unusual properties of an image.
    """
    options = {keyword: value for keyword, value in locals().items()
               if keyword not in ("labels", "affine", "spacing", "progress")}
    made, exception = _of_image(_podm.mesh_file, _podm.mesh_array, labels, affine, spacing, options, progress)
    return _result(made, exception)


def plan(labels: npt.ArrayLike | StrPath, *, affine: npt.ArrayLike | None = None,
         spacing: npt.ArrayLike | None = None, names: Mapping[int, str] | StrPath | None = None,
         keep: LabelValues | None = None, drop: LabelValues | None = None,
         merge: Mapping[str, LabelValues] | None = None, drop_islands: float | None = None,
         background: int | None = None, radius: float | None = None,
         radius_of: Mapping[str | int, float] | None = None, size_image: StrPath | None = None,
         size_near: Mapping[tuple[str | int, str | int], float | tuple[float, float]] | None = None,
         grade: float | None = None, delta: float | None = None, target_elements: int | None = None,
         smooth: float | None = None, min_dihedral: float | None = None, optimize: bool = False,
         algorithm: str | None = None, threads: int | None = None) -> dict[str, Any]:
    """Predicts the cost of mesh() for the same image and options, and the parts that it loses, without meshing.

    Returns the "plan" of `podm info --plan --json`: "cells", "memory_bytes" (the peak of this process), "seconds" on
    this machine, "labels" (the cells of each label, and the volumes of its components, mm^3, the largest first) and
    "thin_parts" (the parts for which delta is too coarse: label, kind, thickness_mm, volume_mm3, place_mm in RAS).
    "kind" is "whole" for a whole component, "bridge" for a connection between parts that stay, "detail" for fins, tips
    and edges.

    Raises podm.Error, as mesh() does. warnings.warn() reports unusual properties of the image.
    """
    options = {keyword: value for keyword, value in locals().items() if keyword not in ("labels", "affine", "spacing")}
    told: dict[str, Any] = json.loads(_of_image(_podm.plan_file, _podm.plan_array, labels, affine, spacing, options))
    for text in told.pop("warnings"):
        warnings.warn(_podm.in_python_terms(text), stacklevel=2)
    return told


def _of_image(of_file: Callable[..., Any], of_array: Callable[..., Any], labels: Any, affine: Any, spacing: Any,
              options: dict[str, Any], *more: Any) -> Any:
    """Calls the function of the extension that takes this kind of image, and returns its result."""
    names = options.pop("names") if isinstance(options["names"], Mapping) else {}
    name_of, arguments = _name_of(names), command_line(options)
    if is_file(labels):
        if affine is not None or spacing is not None:
            raise Error("labels: a file tells where its voxels lie, so that neither affine nor spacing is expected")
        return of_file(path_bytes("labels", labels), name_of, arguments, *more)
    voxels, matrix = voxels_and_affine(labels, affine, spacing)
    return of_array(voxels, matrix, name_of, arguments, *more)


def _name_of(names: Mapping[Any, Any]) -> dict[int, bytes]:
    for value, name in names.items():
        is_named = isinstance(name, str) and is_label_value(value)
        expect(is_named, "names", 'a dict from label values to names, as {1: "liver"},', {value: name})
    return {int(value): text_bytes("names", name) for value, name in names.items()}


def _result(made: _podm.MeshInMemory | None, exception: BaseException | None) -> Mesh:
    if made is not None and isinstance(exception, KeyboardInterrupt) and len(made.cells) > 0:
        raise Interrupted(Mesh(made)) from exception
    if exception is not None:
        raise exception
    result = Mesh(made)
    for text in result.unmet + made.warnings:
        warnings.warn(_podm.in_python_terms(text), stacklevel=3)
    return result


def _options_text() -> str:
    """Returns the options by their keywords, in the format of the program's help."""
    help_text = _podm.options_help()
    lines = []
    for line in help_text[help_text.index("Labels:"):].rstrip().splitlines():
        option = re.match(r"  --\S+( \S+)?", line)  # the option and its type
        width = len(option[0]) if option else 0
        keyword = _podm.in_python_terms(line[:width]).ljust(width)  # keeps descriptions aligned
        lines.append(("    " + keyword + _podm.in_python_terms(line[width:])).rstrip())
    return "\n".join(lines)


mesh.__doc__ = f"{mesh.__doc__}\n    Options and their defaults:\n\n{_options_text()}\n"
