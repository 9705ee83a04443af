"""Conversion of input images (arrays, images of nibabel, files) to voxels and a place in the world."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from .checks import is_bool
from .errors import Error

_MM_OF_UNIT = {"meter": 1000.0, "micron": 0.001}


def is_file(labels: Any) -> bool:
    return isinstance(labels, (str, os.PathLike))


def voxels_and_affine(labels: Any, affine: Any, spacing: Any) -> tuple[np.ndarray, list[float]]:
    """Returns the voxels, copied only if their byte order is foreign, and the 3x4 numbers that map indices to mm."""
    if affine is not None and spacing is not None:
        raise Error("affine and spacing: one of them is expected, not both")
    if hasattr(labels, "dataobj") and hasattr(labels, "affine"):
        if affine is not None or spacing is not None:
            raise Error("labels: the image has an affine of its own, so neither affine nor spacing is expected")
        affine = _affine_of_nibabel(labels)
        labels = labels.dataobj
    return _voxels(labels), _matrix(affine) if affine is not None else _diagonal(spacing)


def _affine_of_nibabel(image: Any) -> np.ndarray:
    """Returns the affine in mm: nibabel leaves the unit of the header as it is."""
    units = getattr(image.header, "get_xyzt_units", lambda: ("mm", None))()
    affine = np.eye(4) if image.affine is None else np.array(image.affine, dtype=float)
    affine[:3] *= _MM_OF_UNIT.get(units[0], 1.0)
    return affine


def _voxels(labels: Any) -> np.ndarray:
    try:
        array = np.asanyarray(labels)
    except (TypeError, ValueError) as error:
        raise Error(f"labels: a 3-D array of integers is expected; numpy cannot convert this value: {error}") from error
    if isinstance(array, np.ma.MaskedArray):
        raise Error("labels: an array without a mask is expected; fill it with the background, as labels.filled(0)")
    if array.dtype == bool:
        array = array.view(np.uint8)
    if array.dtype.kind not in "iuf" or array.dtype.itemsize > 8 or array.dtype == np.float16:
        raise Error(f"labels: a 3-D array of integers is expected (int8 to uint64, bool; float32 and float64 of whole "
                    f"numbers), not of {array.dtype}, {array.ndim}-D")
    return array.astype(array.dtype.newbyteorder("="), copy=False)


def _numbers(keyword: str, value: Any, shape: tuple[int, ...], expected: str) -> np.ndarray:
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise Error(f"{keyword}: {expected} is expected, not {value!r}") from None
    if array.shape != shape:
        raise Error(f"{keyword}: {expected} is expected, not an array of shape {array.shape}")
    if any(map(is_bool, np.asarray(value, dtype=object).flat)):
        raise Error(f"{keyword}: {expected} is expected, not {value!r}")
    return array


def _matrix(affine: Any) -> list[float]:
    matrix = _numbers("affine", affine, (4, 4), "a 4x4 matrix from voxel indices to RAS mm, as nibabel's,")
    if not np.array_equal(matrix[3], (0, 0, 0, 1)):
        raise Error(f"affine: its last row is expected to be 0, 0, 0, 1, not {', '.join(f'{x:g}' for x in matrix[3])}")
    return matrix[:3].ravel().tolist()


def _diagonal(spacing: Any) -> list[float]:
    expected = "three distances of voxels in mm, along the axes of the array,"
    mm = np.ones(3) if spacing is None else _numbers("spacing", spacing, (3,), expected)
    if not (np.isfinite(mm) & (mm > 0)).all():
        raise Error(f"spacing: three positive lengths in mm are expected, not {mm.tolist()}")
    return np.hstack([np.diag(mm), np.zeros((3, 1))]).ravel().tolist()
