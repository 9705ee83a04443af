"""Random runs of `podm mesh` on random images. A seed alone determines each run.

A change of the draws changes the meaning of every seed, including those in stress_seeds.txt. Therefore put new draws
after all old ones.
"""

import dataclasses
import pathlib

import numpy

import random_images

MANAGERS = ["aggressive", "random", "global", "local"]
TOPOLOGY = pathlib.Path(__file__).resolve().parents[2] / "experiments/machines/blacklight.toml"
SHARE_ON_THREADS = 1 / 6
MOST_THREADS = {"virtual": 256, "threads": 16}
VOLUME_CELLS, SURFACE_CELLS = 4.82, 1.57  # constants of mesher/prediction/cost_model.h


@dataclasses.dataclass
class Run:
    seed: int
    image: random_images.RandomImage
    image_name: str
    mesh_name: str
    algorithm: str
    executor: str
    selection: list  # options that `podm replay` needs, too
    options: list    # all options except the selection and outputs
    limits: set      # reasons for which it may end early
    optimizes: bool  # the mesh is made once more, with optimisation

    def foreground(self):
        """Returns a mask of the voxels with a selected label."""
        voxels = self.image.voxels
        option, value = self.selection or ("", 0)
        if option == "--labels":
            return voxels == int(value)
        return (voxels != 0) & (voxels != int(value)) if option == "--drop" else voxels != 0

    @property
    def has_schedule(self):
        return self.algorithm in ("pdr", "pdr-podm")


def chance(rng, share):
    return rng.random() < share


def pick(rng, choices):
    return choices[rng.integers(0, len(choices))]


def power_of_2(rng, low, high):
    return float(2 ** rng.uniform(low, high))


def divisor(rng, number):
    return pick(rng, [n for n in range(1, number + 1) if number % n == 0])


class Sizes:
    """Radius and delta, mm; 0 leaves either to the mesher. They are so large that at most some thousands of cells are
    expected: 10^x, where x is in the given range.
    """

    def __init__(self, rng, image, cells_log10=(2.3, 3.9)):
        self.voxel_mm = image.voxel_mm()
        self.volume_mm3, self.area_mm2 = image.volume_and_area()
        self.radius = self.voxel_mm * power_of_2(rng, -0.5, 3) if chance(rng, 0.9) else 0
        self.delta = self.voxel_mm * power_of_2(rng, -1, 1.5) if chance(rng, 0.35) else 0
        self.longest_mm = max(n * s for n, s in zip(image.voxels.shape, image.spacing))
        most = 10 ** rng.uniform(*cells_log10)
        while self.expected_cells() > most and self.sampling() < 0.4 * self.longest_mm:
            self.radius *= 1.1
            if self.delta or not 0 < self.radius < 4 * self.voxel_mm:
                self.delta = 1.1 * self.sampling()
        self.delta = min(self.delta, 0.5 * self.longest_mm)
        self.largest_radius_mm = max(self.radius, self.sampling())  # of a label; at least the sampling distance

    def sampling(self):
        default = min(2 * self.voxel_mm, self.radius / 2) if self.radius else self.voxel_mm
        return self.delta or default

    def expected_cells(self):
        core = VOLUME_CELLS * self.volume_mm3 / self.radius ** 3 if self.radius else 0
        return core + SURFACE_CELLS * self.area_mm2 / self.sampling() ** 2


def drawn_selection(rng, labels):
    """Returns options, and the labels that have cells of their own."""
    if len(labels) < 2 or not chance(rng, 0.12):
        return [], labels
    one, other = (int(label) for label in rng.choice(labels, 2, replace=False))
    rest = [label for label in labels if label not in (one, other)]
    return pick(rng, [(["--drop", one], [other, *rest]), (["--labels", one], [one]),
                      (["--merge", f"{one},{other}=both"], rest)])


def size_options(rng, sizes, labels):
    """Returns options, and the reasons for which the run may end early."""
    options = ["--radius", f"{sizes.radius:.6g}"] if sizes.radius else []
    options += ["--delta", f"{sizes.delta:.6g}"] if sizes.delta else []
    if chance(rng, 0.05):
        return ["--target-elements", round(10 ** rng.uniform(2.5, 3.5))], set()
    if labels and chance(rng, 0.25):
        for label in rng.choice(labels, min(len(labels), 2), replace=False):
            own = (sizes.radius or 2 * sizes.voxel_mm) * power_of_2(rng, -0.5, 1.5)
            sizes.largest_radius_mm = max(sizes.largest_radius_mm, own)
            options += ["--radius-of", f"{label}={own:.6g}"]
    if chance(rng, 0.06):
        most = 1 + round(sizes.expected_cells() * power_of_2(rng, -5, 0.5))
        return [*options, "--max-elements", most], {"element limit"}
    if chance(rng, 0.06):
        return [*options, "--max-seconds", f"{10 ** rng.uniform(-3.5, -0.7):.6f}"], {"time limit"}
    return options, set()


def worker_options(rng, algorithm, most):
    """Returns the numbers of threads and nodes."""
    threads = round(power_of_2(rng, 0, numpy.log2(most)))
    options = ["--threads", threads]
    if algorithm == "pdr-podm":
        nodes = divisor(rng, threads)
        options = pick(rng, [[*options, "--nodes", nodes], [*options, "--cores-per-node", nodes], options,
                             ["--nodes", nodes, "--cores-per-node", threads // nodes]])
    if algorithm == "auto":
        options += ["--crossover", rng.integers(1, 2 * threads, endpoint=True)]
    if algorithm != "podm" and chance(rng, 0.5):
        options += ["--initial-threads", rng.integers(1, threads, endpoint=True)]
    return options


def leaf_options(rng, sizes):
    """Returns leaf sizes from the size of the image to less than a voxel. There are at most some tens of thousands of
    leaves in a box that reaches beyond the image.
    """
    ratio = pick(rng, [1, 1.5, 2, 4, 7.5])
    options = ["--initial-ratio", ratio] if ratio != 4 or chance(rng, 0.5) else []
    if chance(rng, 0.6):
        box_mm = sizes.longest_mm + 4 * ratio * sizes.largest_radius_mm
        options += ["--leaf-size", f"{max(sizes.longest_mm * power_of_2(rng, -5, 0.5), box_mm / 30):.6g}"]
    return options


def executor_options(rng, executor):
    if executor == "threads":
        return ["--pin", pick(rng, ["compact", "scatter"])] if chance(rng, 0.1) else []
    options = ["--executor", "virtual", "--virtual-cost", pick(rng, ["unit", "measured"])]
    return options + (["--topology", TOPOLOGY] if chance(rng, 0.08) else [])


def drawn_space(rng, image):
    """Draws "voxel" only if angles and radii in voxels equal those in mm, and if the affine consists of 0, 1 and -1.
    Such an affine turns cubes of 1 mm by quarters about the origin and moves no vertex by rounding.
    """
    spaces = ["RAS", "LPS", "voxel"] if numpy.isin(image.affine, [-1, 0, 1]).all() else ["RAS", "LPS"]
    return ["--space", pick(rng, spaces)] if chance(rng, 0.4) else []


def draw(seed, phantoms):
    rng = numpy.random.default_rng(seed)
    image = random_images.draw(rng, phantoms)
    algorithm = pick(rng, ["podm"] * 7 + ["pdr"] * 4 + ["pdr-podm"] * 7 + ["auto"] * 2)
    executor = "threads" if chance(rng, SHARE_ON_THREADS) else "virtual"
    selection, labels = drawn_selection(rng, image.labels())
    sizes = Sizes(rng, image)
    asked, limits = size_options(rng, sizes, labels)
    options = [*asked, "--algorithm", algorithm, *worker_options(rng, algorithm, MOST_THREADS[executor])]
    if algorithm != "podm":
        options += leaf_options(rng, sizes)
    options += executor_options(rng, executor)
    manager = pick(rng, MANAGERS)
    if executor == "virtual" and manager == "aggressive":
        manager = "random"  # it may stall for good (experiments/simulated_contention.toml)
    options += ["--contention", manager, "--begging", pick(rng, ["random", "hierarchical"])]
    options += ["--oversubscribe", "--seed", seed % (1 << 32), *drawn_space(rng, image)]
    files = (pick(rng, ["image.nii", "image.nii", "image.nii.gz"]),
             pick(rng, ["out.vtu", "out.vtu", "out.mesh", "out.msh"]))
    if algorithm == "podm" and chance(rng, 0.5):
        algorithm = "podm-home"
        threads = options[options.index("--threads") + 1]
        options[options.index("--algorithm") + 1] = algorithm
        options += ["--nodes", divisor(rng, threads)]
    if chance(rng, 0.4):
        options += ["--min-dihedral", f"{rng.uniform(2, 20):.3g}"]
    optimizes = chance(rng, 0.3)
    return Run(seed, image, *files, algorithm, executor,
               [str(option) for option in selection], [str(option) for option in options], limits, optimizes)
