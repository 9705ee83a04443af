"""Random small label images: phantoms and extremely degenerate shapes, damaged, in any frame. A random stream alone
determines each image. An array is indexed [x, y, z]; 0 is background and other labels are small integers until `stored`
gives them values.
"""

import dataclasses
import gzip
import os
import struct
import subprocess

import numpy

import small_images

PHANTOMS = [("spheres", 16), ("spheres", 20), ("torus", 16), ("torus", 22), ("abdomen", 16), ("abdomen", 20)]
TYPES = {small_images.UINT8: numpy.uint8, small_images.INT8: numpy.int8, small_images.UINT16: numpy.uint16,
         small_images.INT16: numpy.int16, small_images.UINT32: numpy.uint32, small_images.INT32: numpy.int32,
         small_images.FLOAT32: numpy.float32}


def grid(size):
    """Returns voxel coordinates along each axis, shaped for broadcasting."""
    return numpy.ogrid[tuple(slice(0, n) for n in size)]


def random_point(rng, size):
    return [rng.uniform(0, n) - 0.5 for n in size]


def distances(size, point):
    return numpy.sqrt(sum((x - c) ** 2 for x, c in zip(grid(size), point)))


def balls(rng, size):
    labels = numpy.zeros(size, int)
    for label in range(1, rng.integers(2, 6)):
        labels[distances(size, random_point(rng, size)) <= rng.uniform(0.15, 0.5) * max(size)] = label
    return labels


def shells(rng, size):
    depth = distances(size, random_point(rng, size)) / rng.uniform(1, 3)
    return numpy.maximum(0, rng.integers(2, 6) - depth.astype(int))


def voxels(rng, size):
    labels = numpy.zeros(size, int)
    for label in range(1, rng.integers(2, 5)):
        labels[tuple(rng.integers(0, size))] = label
    return labels


def sheet(rng, size):
    """Returns a sheet about a voxel thick, along voxels or oblique."""
    normal = rng.normal(size=3) if rng.random() < 0.6 else numpy.eye(3)[rng.integers(0, 3)]
    normal = normal / numpy.linalg.norm(normal)
    point = random_point(rng, size)
    height = sum(n * (x - c) for n, x, c in zip(normal, grid(size), point))
    labels = (numpy.abs(height) < rng.uniform(0.5, 1.2)).astype(int)
    return labels if rng.random() < 0.5 else labels + 2 * (height >= 0)


def full(_, size):
    return numpy.ones(size, int)


def checkerboard(rng, size):
    period = rng.integers(1, 4)
    labels = sum(x // period for x in grid(size)) % 2
    return labels + rng.integers(0, 2)


def layers(rng, size):
    axis = rng.integers(0, 3)
    return (grid(size)[axis] // rng.integers(1, 4) + numpy.zeros(size, int)) % rng.integers(2, 5)


def contacts(rng, size):
    """Returns solids that meet in edges and corners."""
    x, y, z = (at < rng.integers(0, n, endpoint=True) for at, n in zip(grid(size), size))
    return (x ^ y ^ (z if rng.random() < 0.5 else z | True)).astype(int)


def tissue(rng, size):
    """Returns many labels: each voxel gets the label of the nearest of random points."""
    count = rng.integers(2, 40)
    nearest = numpy.argmin([distances(size, random_point(rng, size)) for _ in range(count)], axis=0)
    labels = nearest + rng.integers(0, 2)
    labels[distances(size, [(n - 1) / 2 for n in size]) > rng.uniform(0.4, 1) * max(size)] = 0
    return labels


def noise(rng, size):
    return rng.integers(0, rng.integers(2, 6), size) * (rng.random(size) < rng.uniform(0.1, 1))


def tubes(rng, size):
    labels = numpy.zeros(size, int)
    for label in range(1, rng.integers(2, 4)):
        a, b = (numpy.array(random_point(rng, size)) for _ in range(2))
        for t in numpy.linspace(0, 1, 3 * max(size)):
            bent = a + t * (b - a) + 0.15 * max(size) * numpy.sin(6 * t)
            labels[distances(size, bent) <= rng.uniform(0.6, 1.1)] = label
    return labels


def blobs(rng, size):
    smooth = rng.normal(size=size)
    for axis in range(3):
        for _ in range(2):
            smooth = smooth + numpy.roll(smooth, 1, axis) + numpy.roll(smooth, -1, axis)
    return numpy.digitize(smooth, numpy.quantile(smooth, numpy.sort(rng.random(rng.integers(1, 4)))))


# The families, and the longest axis of each. Families with many interfaces give many cells.
FAMILIES = {balls: 16, shells: 14, voxels: 12, sheet: 14, full: 14, checkerboard: 7, layers: 9, contacts: 12,
            tissue: 10, noise: 6, tubes: 14, blobs: 12}


def flip_voxels(rng, labels):
    at = rng.random(labels.shape) < 10 ** rng.uniform(-3, -1)
    labels[at] = rng.integers(0, labels.max() + 2, labels.shape)[at]


def fill_box(rng, labels):
    """Fills a box with background or a label."""
    low = [rng.integers(0, n) for n in labels.shape]
    box = tuple(slice(a, a + rng.integers(1, 4)) for a in low)
    labels[box] = 0 if rng.random() < 0.5 else rng.integers(1, labels.max() + 2)


def swap_labels(rng, labels):
    """Exchanges two labels from some slice on."""
    a, b = rng.integers(0, labels.max() + 1, 2)
    part = labels[rng.integers(0, labels.shape[0]):]
    is_a, is_b = part == a, part == b
    part[is_a], part[is_b] = b, a


def shift_slices(rng, labels):
    along, across = rng.permutation(3)[:2]
    moved = numpy.moveaxis(labels, along, 0)[rng.integers(0, labels.shape[along]):]
    moved[...] = numpy.roll(moved, rng.integers(1, 4), 1 + (across - (across > along)))


def blank_slice(rng, labels):
    axis = rng.integers(0, 3)
    numpy.moveaxis(labels, axis, 0)[rng.integers(0, labels.shape[axis])] = 0


DAMAGES = [flip_voxels, flip_voxels, fill_box, fill_box, swap_labels, shift_slices, blank_slice]


def nifti_voxels(path):
    with open(path, "rb") as file:
        data = file.read()
    size, (datatype,) = struct.unpack_from("<3h", data, 42), struct.unpack_from("<h", data, 70)
    return numpy.frombuffer(data, TYPES[datatype], offset=352).reshape(size, order="F").astype(int)


class Phantoms:
    """Phantoms drawn once by the program, kept as arrays."""

    def __init__(self, program, folder, names=PHANTOMS):
        self.names, self.arrays = names, {}
        for name, size in names:
            path = os.path.join(folder, f"{name}@{size}.nii")
            subprocess.run([program, "phantom", name, "--size", str(size), "-o", path], check=True, capture_output=True)
            self.arrays[name, size] = nifti_voxels(path)

    def draw(self, rng):
        return self.arrays[self.names[rng.integers(0, len(self.names))]].copy()


def drawn_size(rng, longest):
    """Returns a size of any shape: a cube, a slice, a row, a voxel."""
    size = [max(1, round(longest * rng.uniform(0.35, 1))) for _ in range(3)]
    for axis in rng.permutation(3)[:rng.integers(1, 4) if rng.random() < 0.08 else 0]:
        size[axis] = 1
    return tuple(size)


def drawn_spacing(rng):
    """Returns a spacing in mm; anisotropic up to 10:1."""
    spacing = numpy.ones(3)
    if rng.random() < 0.5:
        spacing *= 10 ** rng.uniform(-0.7, 0.7)
    if rng.random() < 0.4:
        spacing *= 10 ** rng.uniform(-0.5, 0.5, 3)
    return spacing


def drawn_frame(rng, spacing):
    """Returns an affine of three rows: axes reversed and exchanged, or oblique."""
    axes = numpy.eye(3)
    if rng.random() < 0.5:
        axes = numpy.diag(rng.choice([-1.0, 1.0], 3))[rng.permutation(3)]
    if rng.random() < 0.3:
        axes = numpy.linalg.qr(rng.normal(size=(3, 3)))[0]
    origin = rng.uniform(-100, 100, 3) if rng.random() < 0.5 else numpy.zeros(3)
    return numpy.column_stack([axes * spacing, origin])


def drawn_values(rng, count, datatype):
    """Returns the values of labels 0 to `count` - 1 in a file: 0 stays 0, the other values are any that the type holds.
    """
    is_float = datatype == small_images.FLOAT32
    largest = 1 << 24 if is_float else min(int(numpy.iinfo(TYPES[datatype]).max), (1 << 32) - 1)
    if rng.random() < 0.5:
        return numpy.arange(count)
    values = set()
    while len(values) < count - 1:
        values.add(int(rng.integers(1, largest, endpoint=True)))
    return numpy.array([0, *rng.permutation(sorted(values))])


@dataclasses.dataclass
class RandomImage:
    family: str
    damages: list
    voxels: numpy.ndarray  # as stored
    datatype: int
    affine: numpy.ndarray
    spacing: numpy.ndarray

    def labels(self):
        """Returns the values in the file, without the background."""
        return [int(value) for value in numpy.unique(self.voxels) if value != 0]

    def voxel_mm(self):
        return float(numpy.prod(self.spacing) ** (1 / 3))

    def volume_and_area(self):
        """Returns mm^3 of foreground, and mm^2 of the faces between labels, counted once for each label at them."""
        padded = numpy.pad(self.voxels, 1)
        area = 0.0
        for axis in range(3):
            one = numpy.delete(padded, 0, axis), numpy.delete(padded, -1, axis)
            sides = (one[0] != one[1]) * ((one[0] != 0).astype(int) + (one[1] != 0))
            area += float(sides.sum()) * float(numpy.prod(self.spacing)) / self.spacing[axis]
        return float((self.voxels != 0).sum() * numpy.prod(self.spacing)), area

    def ball_inside_mm(self, foreground):
        """Returns the radius of a ball in the foreground: every voxel within a voxel's diagonal of its points is
        foreground."""
        padded = numpy.pad(foreground, 1)
        inside, outside = (numpy.argwhere(padded == is_inside) * self.spacing for is_inside in (True, False))
        deepest = max(((outside - point) ** 2).sum(axis=1).min() for point in inside)
        return float(numpy.sqrt(deepest) - numpy.linalg.norm(self.spacing))

    def write(self, path):
        """Writes a NIfTI file, compressed if the name requires it."""
        values = self.voxels.astype(TYPES[self.datatype]).tobytes(order="F")
        data = small_images.nifti_bytes(values, self.voxels.shape, self.datatype, self.affine.tolist())
        with open(path, "wb") as file:
            file.write(gzip.compress(data, 1) if path.endswith(".gz") else data)


def draw(rng, phantoms):
    families = list(FAMILIES)
    family = families[rng.integers(0, len(families))]
    if rng.random() < 0.25:
        name, labels = "phantom", phantoms.draw(rng)
    else:
        name, labels = family.__name__, family(rng, drawn_size(rng, FAMILIES[family])).astype(int)
    damages = []
    for _ in range(rng.integers(0, 4) if rng.random() < 0.6 else 0):
        damage = DAMAGES[rng.integers(0, len(DAMAGES))]
        damage(rng, labels)
        damages.append(damage.__name__)
    if not labels.any():
        labels[tuple(n // 2 for n in labels.shape)] = 1
    datatype = list(TYPES)[rng.integers(0, len(TYPES))]
    spacing = drawn_spacing(rng)
    values = drawn_values(rng, int(labels.max()) + 1, datatype)
    return RandomImage(name, damages, values[labels], datatype, drawn_frame(rng, spacing), spacing)
