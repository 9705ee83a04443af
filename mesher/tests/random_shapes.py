"""Random runs of `podm mesh` with the options for shapes: --lines, --box flat and --thin keep. The images are
polycrystals, blocks cut through phantoms, shells one voxel thick and plates with holes. A seed and the options
determine each run; the image follows from the seed alone. A change of the draws changes the meaning of every seed.
"""

import numpy

import random_images
import small_images
from random_runs import (Run, Sizes, chance, divisor, drawn_space, executor_options, leaf_options, pick, power_of_2,
                         size_options, worker_options)

PHANTOMS = [("abdomen", 40), ("spheres", 28), ("torus", 28)]
CELLS_LOG10 = (2.5, 4.0)  # range of the most cells that are expected without the options
MOST_THREADS = {"virtual": 16, "threads": 2}


def margin(labels, voxels=1):
    """Surrounds an image with background."""
    return numpy.pad(labels, voxels)


def polycrystal(rng, _):
    """Returns 3 to 300 grains of 15 to 100 voxels on average. They fill the image, a box or a ball."""
    count = round(3 * 100 ** rng.random())
    side = min(26, max(6, (count * power_of_2(rng, 4, 6.6)) ** (1 / 3)))
    size = tuple(max(3, round(side * rng.uniform(0.7, 1.3))) for _ in range(3))
    nearest = numpy.full(size, numpy.inf)
    labels = numpy.zeros(size, int)
    for grain in range(1, count + 1):
        away = random_images.distances(size, random_images.random_point(rng, size))
        labels[away < nearest] = grain
        nearest = numpy.minimum(nearest, away)
    around = pick(rng, ["nothing", "margin", "ball"])
    if around == "ball":
        middle = [(n - 1) / 2 for n in size]
        labels[random_images.distances(size, middle) > 0.5 * min(size)] = 0
    return margin(labels) if around == "margin" else labels


def block(rng, phantoms):
    """Returns a box cut from a phantom, which the phantom's objects leave through its sides."""
    whole = phantoms.draw(rng)
    while True:
        size = [min(n, int(rng.integers(5, 23))) for n in whole.shape]
        low = [int(rng.integers(0, n - s, endpoint=True)) for n, s in zip(whole.shape, size)]
        cut = whole[tuple(slice(a, a + s) for a, s in zip(low, size))]
        if cut.any():
            return cut.copy()


def shell(rng, _):
    """Returns shells one voxel thick, one in another: of balls or of boxes, empty or filled."""
    size = tuple(int(rng.integers(10, 23)) for _ in range(3))
    away = [numpy.abs(x - (n - 1) / 2) * max(size) / n for x, n in zip(random_images.grid(size), size)]
    depth = numpy.sqrt(sum(x ** 2 for x in away)) if chance(rng, 0.6) else numpy.maximum.reduce(
        numpy.broadcast_arrays(*away))
    labels = numpy.zeros(size, int)
    outer = max(size) / 2 - rng.uniform(0.5, 2)
    for label in range(1, rng.integers(2, 5)):
        labels[(depth <= outer) & (depth > outer - 1)] = label
        outer -= rng.uniform(2, 5)
    if chance(rng, 0.4):
        labels[depth <= outer] = labels.max() + 1
    return labels


def plate(rng, _):
    """Returns a plate of one to three layers, each one to three voxels thick, with round holes."""
    size = tuple(int(rng.integers(9, 23)) for _ in range(2))
    layers = [label for label in range(1, rng.integers(2, 5)) for _ in range(rng.integers(1, 4))]
    labels = numpy.broadcast_to(numpy.array(layers), (*size, len(layers))).copy()
    filling = labels.max() + 1 if chance(rng, 0.3) else 0
    for _ in range(rng.integers(1, 7)):
        away = random_images.distances(size, random_images.random_point(rng, size)[:2])
        labels[away <= rng.uniform(0.6, 3)] = filling
    labels = numpy.transpose(labels, rng.permutation(3))
    return margin(labels, int(rng.integers(1, 3))) if chance(rng, 0.8) else labels


FAMILIES = [polycrystal, polycrystal, block, shell, plate]


def draw_image(rng, phantoms):
    family = pick(rng, FAMILIES)
    labels = family(rng, phantoms)
    spacing = random_images.drawn_spacing(rng)
    datatype = pick(rng, [small_images.UINT16, small_images.INT32])
    return random_images.RandomImage(family.__name__, [], labels, datatype,
                                     random_images.drawn_frame(rng, spacing), spacing)


def smoothing(rng, image):
    """Returns a width of blurring that the image has room for."""
    if not chance(rng, 0.5):
        return []
    side_mm = min(n * s for n, s in zip(image.voxels.shape, image.spacing))
    width_mm = min(image.spacing.min() * rng.uniform(0.4, 1.6), 0.9 * side_mm)
    return ["--smooth", f"{width_mm:.4g}"]


def drawn_algorithm(rng, sizes, has_target):
    executor = "threads" if chance(rng, 0.6) else "virtual"
    algorithm = pick(rng, ["podm"] * 4 + ["podm-home"] * 2 + ["pdr"] * 2 + ["pdr-podm"] * 2)
    options = ["--algorithm", algorithm, *worker_options(rng, algorithm, MOST_THREADS[executor])]
    if algorithm == "podm-home":
        options += ["--nodes", divisor(rng, options[options.index("--threads") + 1])]
    leaves = leaf_options(rng, sizes) if algorithm.startswith("pdr") else []
    if has_target:  # sizes are found by a search, and a drawn leaf may be too small for them
        leaves = []
    return algorithm, executor, options + leaves + executor_options(rng, executor)


def draw(seed, shape_options, phantoms):
    """Returns the run of a seed with these options, a list of words."""
    rng = numpy.random.default_rng(seed)
    image = draw_image(rng, phantoms)
    sizes = Sizes(rng, image, CELLS_LOG10)
    options, limits = size_options(rng, sizes, image.labels())
    smooth = smoothing(rng, image)
    algorithm, executor, workers = drawn_algorithm(rng, sizes, "--target-elements" in options)
    options += [*smooth, *workers, "--oversubscribe", "--seed", seed % (1 << 32), *drawn_space(rng, image)]
    files = "image.nii", pick(rng, ["out.vtu", "out.vtu", "out.mesh", "out.msh"])
    dihedral = ["--min-dihedral", f"{rng.uniform(2, 15):.3g}"] if chance(rng, 0.25) else []
    lines_delta = sizes.sampling() * power_of_2(rng, -1, 1)
    if "--thin" not in shape_options:
        options += dihedral
    if "--lines" in shape_options and chance(rng, 0.3) and "--target-elements" not in options:
        options += ["--lines-delta", f"{lines_delta:.4g}"]
    if "--thin" in shape_options and "--target-elements" in options:
        at = options.index("--target-elements")
        options[at:at + 2] = ["--radius", f"{sizes.radius or 2 * sizes.voxel_mm:.6g}"]
    return Run(seed, image, *files, algorithm, executor, [],
               [str(option) for option in [*options, *shape_options]], limits, False)
