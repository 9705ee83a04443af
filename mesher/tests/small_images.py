"""Small hand-written image files, valid and faulty."""

import struct
import zlib

# NIfTI-1 datatype codes.
UINT8, INT16, INT32, FLOAT32, FLOAT64, RGB24, INT8, UINT16, UINT32 = 2, 4, 8, 16, 64, 128, 256, 512, 768
INT64, UINT64 = 1024, 1280
_BYTES = {UINT8: 1, INT16: 2, INT32: 4, FLOAT32: 4, FLOAT64: 8, RGB24: 3, INT8: 1, UINT16: 2, UINT32: 4, INT64: 8,
          UINT64: 8}


def voxels_of(size, label_at):
    """Returns a cube of `size` voxels labelled by label_at(i, j, k), as bytes."""
    return bytes(int(label_at(i, j, k)) for k in range(size) for j in range(size) for i in range(size))


def ball_voxels(size):
    """Returns label 1 in the middle of a cube of `size` voxels, as bytes."""
    middle = (size - 1) / 2
    return voxels_of(size, lambda *ijk: sum((x - middle) ** 2 for x in ijk) <= (size / 3) ** 2)


def nifti_bytes(voxels, dimensions=(12, 12, 12), datatype=UINT8, affine=None, magic=b"n+1\0"):
    """Returns the bytes of a NIfTI-1 file; `affine` is three rows of four numbers."""
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, len(dimensions), *dimensions, *([1] * (7 - len(dimensions))))
    struct.pack_into("<hh", header, 70, datatype, 8 * _BYTES[datatype])
    struct.pack_into("<8f", header, 76, 1, *([1] * 7))
    struct.pack_into("<f", header, 108, 352)
    struct.pack_into("<f", header, 112, 1)
    header[123] = 2  # mm
    struct.pack_into("<h", header, 254, 1)
    rows = affine or ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0))
    struct.pack_into("<12f", header, 280, *rows[0], *rows[1], *rows[2])
    header[344:348] = magic
    return bytes(header) + voxels


def write_nifti(path, *arguments, **options):
    """Writes the result of nifti_bytes() to a file."""
    path.write_bytes(nifti_bytes(*arguments, **options))
    return path


def write_nrrd(path, voxels, size, type_name):
    """Writes a NRRD file of size^3 voxels."""
    path.write_bytes(f"NRRD0004\ntype: {type_name}\ndimension: 3\nspace: left-posterior-superior\n"
                     f"sizes: {size} {size} {size}\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nendian: little\n"
                     "encoding: raw\nspace origin: (0,0,0)\n\n".encode() + voxels)
    return path


def write_metaimage(path, voxels, size=12, spacing="1 1 1", compressed_size=None, element_type="MET_UCHAR"):
    """Writes a MetaImage file. `spacing` is written as given, and so is the size of the compressed stream."""
    compression = ""
    if compressed_size is not None:
        voxels = zlib.compress(voxels)
        compression = f"CompressedData = True\nCompressedDataSize = {compressed_size}\n"
    header = (f"ObjectType = Image\nNDims = 3\n{compression}DimSize = {size} {size} {size}\n"
              f"ElementSpacing = {spacing}\nElementType = {element_type}\nElementByteOrderMSB = False\n"
              "BinaryData = True\nElementDataFile = LOCAL\n")
    path.write_bytes(header.encode() + voxels)
    return path
