"""podm.mesh and podm.plan: an image in, a mesh out, or a prediction of it."""

from __future__ import annotations

import inspect
import json
import os
import warnings
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from . import _podm
from .checks import expect, is_label_value, path_bytes, text_bytes
from .errors import Error, Interrupted
from .images import is_file, voxels_and_affine
from .keywords import TYPES, Option, default_of, options_of_mesh, options_of_plan
from .result import Mesh

if TYPE_CHECKING:
    import numpy.typing as npt

    StrPath = str | os.PathLike[str]


def mesh(labels: npt.ArrayLike | StrPath, *, affine: npt.ArrayLike | None = None,
         spacing: npt.ArrayLike | None = None, names: Mapping[int, str] | StrPath | None = None,
         progress: Callable[[_podm.Progress], object] | None = None, **options: Any) -> Mesh:
    """Meshes a label image into tetrahedra.

    Everything except the image is optional; None means the mesher's default. Options have the names, meanings and
    defaults of `podm mesh`; they are listed below.

    labels
        The image: an array of shape (ni, nj, nk) of any integer type, in any memory order, with values from 0 to
        2^32 - 1 (it is read and not copied; the mesher makes its own labels of 2 bytes per voxel); or an image of
        nibabel; or the name of a NIfTI, NRRD, MetaImage or INR file, or phantom:NAME[@SIZE].
    affine
        The 4x4 matrix, as nibabel's, from voxel indices (i, j, k) to RAS coordinates in mm. It must be invertible. A
        matrix with shear changes angles: the bounds on shape then hold in the image's own axes.
    spacing
        The three distances of voxels, mm, in place of an affine, for arrays only; voxel (0, 0, 0) lies at the origin.
        The default is 1 mm.
    names
        Names of labels, as {1: "liver"}; or a file of names and colours: a table of ITK-SNAP, FreeSurfer or 3D Slicer
        (.ctbl), or lines "value name". They replace those in the image.
    progress
        Is called with a podm.Progress a few times per second, by the thread that called mesh(). An exception that it
        raises ends the run, and mesh() raises it again.

    Other Python threads run meanwhile and may mesh, too.

    Raises podm.Error, a ValueError, for a fault of image or options; MemoryError; and podm.Interrupted, a
    KeyboardInterrupt, if Ctrl-C ends the run early: its `mesh` is the mesh so far, which is valid. A limit
    (max_elements, max_seconds) raises nothing: the mesh so far is returned, and its `is_complete` is False. Guarantees
    that a mesh misses and oddities of an image are reported by warnings.warn().
    """
    _refuse_unknown("mesh", options)
    made, exception = _of_image(_podm.mesh_file, _podm.mesh_array, labels, affine, spacing, names, options, progress)
    return _result(made, exception)


def plan(labels: npt.ArrayLike | StrPath, *, affine: npt.ArrayLike | None = None,
         spacing: npt.ArrayLike | None = None, names: Mapping[int, str] | StrPath | None = None,
         **options: Any) -> dict[str, Any]:
    """Predicts the cost and the losses of mesh() of the same image and options, without meshing the image.

    Returns the contents of "plan" of `podm info --plan --json`: "cells", "memory_bytes" (the peak of this process),
    "seconds" on this machine, "labels" (the cells of each, and the volumes of its components, mm^3, the largest first)
    and "thin_parts" (structures too thin for delta: label, kind, thickness_mm, volume_mm3, place_mm in RAS). "kind" is
    "whole" for an entire component, "bridge" for a part that joins parts which stay, "detail" for fins, tips and edges.

    Raises podm.Error, as mesh() does. Oddities of the image are reported by warnings.warn().
    """
    _refuse_unknown("plan", options)
    predicted: dict[str, Any] = json.loads(
        _of_image(_podm.plan_file, _podm.plan_array, labels, affine, spacing, names, options))
    for text in predicted.pop("warnings"):
        warnings.warn(text, stacklevel=2)
    return predicted


def _of_image(of_file: Callable[..., Any], of_array: Callable[..., Any], labels: Any, affine: Any, spacing: Any,
              names: Any, options: dict[str, Any], *more: Any) -> Any:
    """Returns the result of that one of two functions of the extension which takes the image."""
    name_of = _name_of(names) if isinstance(names, Mapping) else {}
    if names is not None and not isinstance(names, Mapping):
        expect(isinstance(names, (str, os.PathLike)), "names",
               'a dict from label values to names, as {1: "liver"}, or the name of a file', names)
        options = options | {"names": names}
    if is_file(labels):
        if affine is not None or spacing is not None:
            raise Error("labels: a file has an affine of its own, so neither affine nor spacing is expected")
        return of_file(path_bytes("labels", labels), name_of, options, *more)
    voxels, matrix = voxels_and_affine(labels, affine, spacing)
    return of_array(voxels, matrix, name_of, options, *more)


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
        warnings.warn(text, stacklevel=3)
    return result


_OPTIONS: list[Option] = json.loads(_podm.options())
_OF_MESH, _OF_PLAN = options_of_mesh(_OPTIONS), options_of_plan(_OPTIONS)
_GROUPS = list(dict.fromkeys(option["group"] for option in _OF_MESH))


def _refuse_unknown(function: str, options: Mapping[str, Any]) -> None:
    known = {option["keyword"] for option in (_OF_MESH if function == "mesh" else _OF_PLAN)}
    for keyword in options:
        if keyword not in known:
            raise TypeError(f"{function}() got an unexpected keyword argument {keyword!r}")


def _declare(function: Callable[..., Any], options: list[Option]) -> None:
    """Gives a function the signature and the description of its options."""
    signature = inspect.signature(function)
    own = [parameter for parameter in signature.parameters.values() if parameter.kind is not parameter.VAR_KEYWORD]
    keywords = [inspect.Parameter(option["keyword"], inspect.Parameter.KEYWORD_ONLY, default=default_of(option),
                                  annotation=TYPES[option["kind"]]) for option in options]
    function.__signature__ = signature.replace(parameters=own + keywords)  # type: ignore[attr-defined]
    function.__doc__ = f"{function.__doc__}\n    Options and their defaults:\n{_options_text(options)}\n"


def _options_text(options: list[Option]) -> str:
    lines, group = [], ""
    for option in sorted(options, key=lambda option: _GROUPS.index(option["group"])):
        if option["group"] != group:
            group = option["group"]
            lines += ["", f"    {group.partition(' (')[0]}"]
        default = option["unset"] or option["default"]
        text = f"{_in_keywords(option['help'])}\n[default: {_in_keywords(str(default))}]"
        lines.append(f"      {option['keyword']:<18} " + text.replace("\n", "\n" + " " * 25))
    return "\n".join(lines)


def _in_keywords(text: str) -> str:
    for option in _OPTIONS:
        text = text.replace("--" + option["name"], option["keyword"])
    return text


_declare(mesh, _OF_MESH)
_declare(plan, _OF_PLAN)
