"""The mesh and the image as the page draws them."""
import threading

import numpy
from report_page.viewer import parts_of
from views.colours import colours_by_rank
from views.read_mesh import read_mesh

MOST_CELLS = 2_000_000  # that the page turns
MOST_SHOWN_BYTES = 512 << 20  # of the image whose slices the page shows
LARGEST_INDEX = 65535
VOXELS_AT = 352  # in the NIfTI files that podm writes
NIFTI_TYPES = {2: "<u1", 512: "<u2", 8: "<i4", 768: "<u4"}


LOADING = threading.Lock()


def load_vtk():
    """Loads VTK, which takes a second. Only one thread may do so at a time, because VTK replaces its own module."""
    with LOADING:
        import vtk  # noqa: F401


def load_vtk_meanwhile():
    """Loads VTK while the server waits for an image."""
    threading.Thread(target=load_vtk, daemon=True).start()


def colours_of_image(labels):
    """Returns a colour per label value: the label's own, otherwise one by rank of volume, as in pages and pictures."""
    ranked = sorted(labels, key=lambda label: -label["voxels"])
    own = {label["value"]: label["colour"] for label in labels if label["colour"]}
    return colours_by_rank([label["value"] for label in ranked]) | own


def make_showable(path, values):
    """Replaces label values by their positions from 1, if they are too large for a table of colours. Returns the
    number that stands for each value in the file; None if the image is too large to show."""
    if path.stat().st_size > MOST_SHOWN_BYTES:
        path.unlink()
        return None
    if max(values) <= LARGEST_INDEX:
        return values
    data = numpy.fromfile(path, numpy.uint8)
    header, voxels = data[:VOXELS_AT].copy(), data[VOXELS_AT:].view(NIFTI_TYPES[int(data[70:72].view("<i2")[0])])
    positions = numpy.searchsorted(values, voxels.clip(min=0).astype(numpy.uint32))
    positions[positions == len(values)] = 0
    found = numpy.where(numpy.array(values, numpy.uint32)[positions] == voxels.astype(numpy.uint32), positions + 1, 0)
    header[70:74] = numpy.array([512, 16], "<i2").view(numpy.uint8)
    path.write_bytes(header.tobytes() + found.astype("<u2").tobytes())
    return list(range(1, len(values) + 1))


def mesh_parts(path, num_cells, colours):
    """Returns the description and the bytes for viewer.js; None, without reading, for more than MOST_CELLS cells."""
    if num_cells > MOST_CELLS:
        return None
    load_vtk()
    return parts_of(read_mesh(path), colours)
