"""Reads the label values of an image file, by voxel [x, y, z]. podm info gives their positions."""
import gzip
import math

import numpy

_NIFTI = {2: "u1", 4: "<i2", 8: "<i4", 16: "<f4", 256: "i1", 512: "<u2", 768: "<u4"}
_NRRD = {"uint8": "u1", "unsigned char": "u1", "uchar": "u1", "short": "<i2", "int16": "<i2", "ushort": "<u2",
         "unsigned short": "<u2", "uint16": "<u2", "int": "<i4", "int32": "<i4", "uint32": "<u4"}


def read_volume(path):
    """Raises ValueError for unknown formats and byte orders."""
    with (gzip.open if str(path).endswith(".gz") else open)(path, "rb") as file:
        data = file.read()
    for ending, read in ((".nii", _nifti), (".nrrd", _nrrd), (".inr", _inr)):
        if str(path).removesuffix(".gz").endswith(ending):
            size, kind, voxels = read(data)
            return numpy.frombuffer(voxels, kind, math.prod(size)).reshape(size, order="F").astype(numpy.int64)
    raise ValueError(f"{path}: neither NIfTI, NRRD nor INR")


def _nifti(data):
    if data[:4] != b"\x5c\x01\0\0":
        raise ValueError("a little-endian NIfTI-1 header is expected")
    size = numpy.frombuffer(data, "<i2", 3, 42)
    offset = int(numpy.frombuffer(data, "<f4", 1, 108)[0])
    return tuple(map(int, size)), _NIFTI[int(numpy.frombuffer(data, "<i2", 1, 70)[0])], data[offset:]


def _nrrd(data):
    head, _, voxels = data.partition(b"\n\n")
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
    if fields.get("endian", "little") != "little":
        raise ValueError("little-endian NRRD is expected")
    if fields["encoding"] in ("gzip", "gz"):
        voxels = gzip.decompress(voxels)
    return tuple(map(int, fields["sizes"].split())), _NRRD[fields["type"]], voxels


def _inr(data):
    fields = dict(line.split("=") for line in data[:256].decode("latin1").splitlines() if "=" in line)
    return tuple(int(fields[axis]) for axis in ("XDIM", "YDIM", "ZDIM")), "u1", data[256:]
