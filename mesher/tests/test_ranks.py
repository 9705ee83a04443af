"""podm-mpi as a user runs it: its meshes on several ranks, its refusals, and the end of a run whose ranks fail or are
stopped. Needs $PODM_MPI_PROGRAM and $PODM_MPIRUN, which are empty without MPI."""

import gzip
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import time
import unittest

from mpi_environment import mpi_environment
from podm_process import PROGRAM, PodmTestCase, run_podm, start_podm
from slow import few, slow
from small_images import INT8, ball_voxels, nifti_bytes, voxels_of, write_metaimage, write_nifti, write_nrrd

MPI_PROGRAM, MPIRUN = os.environ["PODM_MPI_PROGRAM"], os.environ["PODM_MPIRUN"]
VERIFIER = os.path.join(os.path.dirname(PROGRAM), "podm-verify")
IMAGE = "phantom:spheres@32"
ENDLESS = ["phantom:abdomen@64", "--radius", 2.0]  # takes tens of seconds and about a GiB
LONGER = ["phantom:abdomen@64", "--radius", 1.5]  # goes on for seconds after a rank ends, also on a busy machine
ENVIRONMENT = {}  # of MPI programs
# Limits the size of files. MPICH must then not keep messages in files of shared memory.
FULL_DISK = "ulimit -f 16; export UCX_TLS=self,tcp"


def setUpModule():
    ENVIRONMENT.update(unittest.enterModuleContext(mpi_environment()))


def on_ranks(*ranks):
    """Returns mpirun's arguments for the arguments of podm-mpi on each rank."""
    parts = []
    for arguments in ranks:
        parts += [":"] * bool(parts) + ["-n", 1, MPI_PROGRAM, *arguments]
    return parts


def ranks_below(process):
    """Returns the processes of podm-mpi that a process has started, itself or through others."""
    children = pathlib.Path(f"/proc/{process}/task/{process}/children").read_text().split()
    program = os.path.realpath(MPI_PROGRAM)
    ranks = [int(child) for child in children if os.path.realpath(f"/proc/{child}/exe") == program]
    return ranks + [rank for child in children for rank in ranks_below(child)]


@unittest.skipUnless(MPI_PROGRAM, "MPI was not found when this was configured")
class OnRanks(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out.pvtu"
        self.runs = self.folder / "runs.jsonl"

    def mpirun(self, *arguments, **options):
        return run_podm(*arguments, program=MPIRUN, env=ENVIRONMENT, **options)

    def mesh(self, number, *arguments, image=IMAGE, out=None):
        return self.mpirun("-n", number, MPI_PROGRAM, "mesh", image, "-o", out or self.out,
                           "--record", self.runs, *arguments)

    def assert_verifies(self, path, *options):
        report = self.folder / "report.json"
        self.assert_exit(run_podm(path, "--json", report, *options, program=VERIFIER), 0)
        claims = json.loads(report.read_text())["claims"]
        decided = {claim for claim, result in claims.items() if result["verdict"] == "pass"}
        self.assertLessEqual({"structure", "delaunay", "conformity", "surface", "radius_edge"}, decided)

    def mesh_in_process(self, number, *arguments, out=None):
        return run_podm("mesh", IMAGE, "-o", out or self.out, "--record", self.runs, "--in-process", number,
                        *arguments, program=MPI_PROGRAM, env=ENVIRONMENT)

    def last_record(self):
        return json.loads(self.runs.read_text().splitlines()[-1])

    def names(self):
        return {path.name for path in self.folder.iterdir()}


class Meshes(OnRanks):
    def test_any_number_of_ranks_makes_a_whole_mesh_that_verifies(self):
        image = self.folder / "spheres.nii.gz"
        self.assert_exit(run_podm("phantom", "spheres", "--size", 32, "-o", image), 0)
        cells = {}
        for number in 1, 2, 4:
            with self.subTest(ranks=number):
                self.assert_exit(self.mesh(number, "--radius", 4, image=image), 0)
                self.assert_verifies(self.out, "--radius", 4, "--image", image)
                pieces = {f"out_{i}{facets}.vtu" for i in range(number) for facets in ("", "_facets")}
                self.assertLessEqual(pieces | {"out.pvtu", "out_facets.pvtu"}, self.names())
                record = self.last_record()
                cells[number] = record["cells"]
                ranks = record["ranks"]
                self.assertEqual([ranks["number"], ranks["machines"], len(ranks["by_rank"])], [number, 1, number])
                self.assertEqual(sum(rank["cells"] for rank in ranks["by_rank"]), record["cells"])
                for rank in ranks["by_rank"]:
                    self.assertLessEqual({"transform", "refine", "extract"}, set(rank["spent"]))
                    self.assertGreater(rank["spent"]["refine"]["computing_s"], 0)
                self.assertEqual(sum(label["cells"] for label in record["labels"]), record["cells"])
                self.assertEqual(sum(pair["facets"] for pair in record["facet_pairs"]), record["boundary_facets"])
                self.assertEqual(bool(ranks["rounds"]), number > 1)
                self.assertTrue(all(round["deferred"] == 0 for round in ranks["rounds"][-1:]))
        self.assertLess(max(cells.values()) / min(cells.values()), 1.02)

    @slow
    def test_leaf_by_leaf_in_each_rank(self):
        image = self.folder / "spheres.nii.gz"
        self.assert_exit(run_podm("phantom", "spheres", "--size", 32, "-o", image), 0)
        for options in (["pdr-podm", "--nodes", 2, "--cores-per-node", 2], ["pdr", "--threads", 2]):
            with self.subTest(options=options):
                process = self.mesh(2, "--radius", 3, "--algorithm", *options, "--log", self.folder / "run.log",
                                    "--oversubscribe", image=image)
                self.assert_exit(process, 0)
                self.assertIn(f"by {options[0]};", process.stderr)
                self.assert_verifies(self.out, "--radius", 3, "--image", image)
                self.assert_exit(run_podm("replay", image, *(self.folder / f"run.log.{i}" for i in range(2))), 0)
                record = self.last_record()
                first, *later = record["ranks"]["rounds"]
                self.assertEqual(record["algorithm"], options[0])
                self.assertEqual(record["leaves"]["nodes"], 2)
                self.assertGreater(record["leaves"]["number"], 100)
                self.assertGreater(first["in_leaves"], first["insertions"] / 2)
                self.assertEqual({round["in_leaves"] for round in later}, {0})
                self.assertLessEqual({"octree", "refine", "closing"}, set(record["phases_s"]))

    def test_one_rank_makes_the_mesh_of_podm(self):
        for algorithm in "podm", "pdr-podm":
            with self.subTest(algorithm=algorithm):
                self.assert_is_mesh_of_podm("--radius", 4, "--threads", 1, "--algorithm", algorithm)

    def assert_is_mesh_of_podm(self, *options):
        self.assert_exit(self.mesh(1, *options), 0)
        alone = self.folder / "alone.vtu"
        self.assert_exit(run_podm("mesh", IMAGE, *options, "-o", alone, "--record", self.runs), 0)
        ours, theirs = map(json.loads, self.runs.read_text().splitlines()[-2:])
        for key in "cells", "vertices", "boundary_facets", "labels", "facet_pairs", "quality", "counters":
            if key == "counters":
                ours[key].pop("store_cells"), theirs[key].pop("store_cells")
            self.assertEqual(ours[key], theirs[key], key)

    @slow
    def test_as_many_ranks_of_one_thread_make_the_same_mesh(self):
        contents = []
        for _ in range(2):
            self.assert_exit(self.mesh(3, "--radius", 3.5, "--threads", 1), 0)
            contents.append([(self.folder / f"out_{i}.vtu").read_bytes() for i in range(3)])
        self.assertEqual(*contents)

    @slow
    def test_a_mesh_of_less_pieces_replaces_one_of_more(self):
        for number in 4, 2:
            self.assert_exit(self.mesh(number, "--radius", 4), 0)
        self.assertNotIn("out_2.vtu", self.names())
        self.assert_verifies(self.out)

    @slow
    def test_xdmf_voxel_space_and_verification(self):
        self.assert_exit(self.mesh(2, "--radius", 4, out=self.folder / "out.xdmf"), 0)
        self.assertLessEqual({"out.xdmf", "out.h5"}, self.names())
        self.assert_exit(self.mesh(2, "--radius", 4, "--space", "voxel"), 0)
        self.assert_exit(self.mesh(2, "--radius", 4, "--verify"), 0)
        self.assertEqual(set(self.last_record()["verdicts"].values()), {"pass"})

    def test_smooth_interfaces_and_sizes_by_place(self):
        for options in (["--smooth", 1.5], ["--size-near", "1,0=2:3", "--grade", 0.3]):
            with self.subTest(options=options):
                log = self.folder / "run.log"
                process = self.mesh_in_process(3, "--radius", 5, *options, "--verify", "--log", log)
                self.assert_exit(process, 0)
                record = self.last_record()
                self.assertEqual(set(record["verdicts"].values()), {"pass"})
                self.assertLessEqual({"size", "surface_vertices"}, set(record["verdicts"]))
                self.assert_exit(run_podm("replay", IMAGE, *(self.folder / f"run.log.{i}" for i in range(3))), 0)
                self.assert_exit(run_podm("mesh", IMAGE, "--radius", 5, *options, "-o", self.folder / "alone.vtu",
                                          "--record", self.runs), 0)
                self.assertLess(abs(record["cells"] / self.last_record()["cells"] - 1), 0.03)

    def test_r7_moves_vertices_on_ranks(self):
        for threads in 1, 2:
            with self.subTest(threads=threads):
                log, radius, angle = self.folder / "run.log", 3, 12
                process = self.mesh_in_process(4, "--radius", radius, "--min-dihedral", angle, "--threads", threads,
                                               "--oversubscribe", "--verify", "--log", log)
                self.assert_exit(process, 0)
                record = self.last_record()
                self.assertEqual(set(record["verdicts"].values()), {"pass"})
                self.assert_exit(run_podm("replay", IMAGE, *(self.folder / f"run.log.{i}" for i in range(4))), 0)
                self.assert_exit(run_podm("mesh", IMAGE, "--radius", radius, "--min-dihedral", angle, "-o",
                                          self.folder / "alone.vtu", "--record", self.runs), 0)
                ours, theirs = record["perturbed"], self.last_record()["perturbed"]
                self.assertEqual(sum(ours["after"].values()), sum(ours["unmoved"].values()))
                self.assertEqual(ours["unmoved"]["not_reached"], 0)
                for name in "before", "after":
                    self.assertLess(sum(ours[name].values()), 1.2 * sum(theirs[name].values()) + 20)
                self.assertGreater(sum(ours["before"].values()), 0.8 * sum(theirs["before"].values()))
                self.assertGreater(len(record["ranks"]["perturbing_rounds"]), 1)

    def test_surfaces_are_those_of_the_pieces(self):
        surface = self.folder / "s.ply"
        self.assert_exit(self.mesh(3, "--radius", 4, "--surface", surface), 0)
        names = {name for name in self.names() if name.startswith("s_")}
        self.assertTrue(names)
        written = {name: (self.folder / name).stat().st_size for name in names}
        self.assert_exit(run_podm("convert", self.out, surface), 0)
        self.assertEqual({name: (self.folder / name).stat().st_size for name in names}, written)

    def test_more_ranks_than_there_is_to_do(self):
        image = write_nifti(self.folder / "ball.nii", ball_voxels(12))
        self.assert_exit(self.mesh(6, "--radius", 6, "--delta", 3, image=image), 0)
        self.assert_verifies(self.out, "--radius", 6)

    def test_the_summary_is_printed_once(self):
        process = self.mesh(2, "--radius", 4)
        for words in ("guarantees all met", "deferred", "memory per rank"):
            self.assertEqual(process.stderr.count(words), 1, words)

    def test_ranks_that_ask_for_more_threads_than_there_are_are_warned(self):
        processors = len(os.sched_getaffinity(0))
        process = self.mesh(processors + 1, "--radius", 6)
        self.assert_exit(process, 0)
        self.assertRegex(process.stderr, f"warning: .*: {processors + 1} ranks request {processors + 1} threads")

    def test_more_than_one_rank_per_machine_is_warned_of_once(self):
        for number in 1, 2:
            process = self.mesh(number, "--radius", 6, "--threads", 1)
            self.assert_exit(process, 0)
            self.assertEqual(process.stderr.count("one rank per machine"), number - 1)

    def test_help_fits_a_terminal_and_names_what_is_refused(self):
        process = self.mpirun("-n", 1, MPI_PROGRAM, "mesh", "--help")
        self.assert_exit(process, 0)
        self.assertLessEqual(max(map(len, process.stdout.splitlines())), 110)
        self.assertIn("Not on ranks: --report; the page", process.stdout)


class InProcess(OnRanks):
    def test_what_a_killed_run_of_more_ranks_has_left_goes(self):
        left = {"out_7.vtu.tmp1-0", "out_7_facets.vtu.tmp1-1", "run.log.9.tmp1-2"}
        others = {"out_x.vtu.tmp1-0", "out_7.vtu.tmp", "out_7.vtk.tmp1-0", "else_7.vtu.tmp1-0", "run.log.x.tmp1-2"}
        for name in left | others:
            (self.folder / name).touch()
        self.assert_exit(self.mesh_in_process(2, "--radius", 9, "--log", self.folder / "run.log"), 0)
        self.assertEqual(self.names() & (left | others), others)

    def contents(self, number, out=None):
        path = out or self.out
        return [path.with_name(f"{path.stem}_{i}.vtu").read_bytes() for i in range(number)]

    def test_they_make_the_mesh_of_as_many_processes(self):
        self.assert_exit(self.mesh(3, "--radius", 3.5, "--threads", 1), 0)
        by_mpi = self.contents(3)
        process = self.mesh_in_process(3, "--radius", 3.5)
        self.assert_exit(process, 0)
        self.assertEqual(self.contents(3), by_mpi)
        self.assertEqual(process.stderr.count("guarantees all met"), 1)
        theirs, ours = (json.loads(line)["ranks"] for line in self.runs.read_text().splitlines())
        self.assertEqual([theirs["carrier"], ours["carrier"]], ["mpi", "in-process"])
        self.assertEqual([rank["cells"] for rank in theirs["by_rank"]], [rank["cells"] for rank in ours["by_rank"]])
        self.assertTrue(all(rank["virtual"] is None and rank["peak_rss_bytes"] > 0 for rank in theirs["by_rank"]))
        self.assertTrue(all(rank["peak_rss_bytes"] is None for rank in ours["by_rank"]))

    @slow
    def test_seeds_draw_cuts_and_meshes_verify(self):
        image = self.folder / "spheres.nii.gz"
        self.assert_exit(run_podm("phantom", "spheres", "--size", 32, "-o", image), 0)
        cells_of_ranks = set()
        for seed in range(4):
            with self.subTest(seed=seed):
                self.assert_exit(self.mesh_in_process(5, "--radius", 4, "--seed", seed, "--initial-ratio", 1.5), 0)
                self.assert_verifies(self.out, "--radius", 4, "--image", image)
                record = self.last_record()
                self.assertEqual(record["seed"], seed)
                self.assertEqual(record["ranks"]["initial_ratio"], 1.5)
                cells_of_ranks.add(tuple(rank["cells"] for rank in record["ranks"]["by_rank"]))
                phases = [set(rank["phases_s"]) for rank in record["ranks"]["by_rank"]]
                self.assertEqual(phases, 5 * phases[:1])  # also ranks that have nothing to refine
        self.assertEqual(len(cells_of_ranks), 4)

    def test_a_seed_is_drawn_alike_by_processes(self):
        options = ["--radius", 4, "--seed", 9, "--threads", 1]
        self.assert_exit(self.mesh(4, *options), 0)
        by_mpi = self.contents(4)
        self.assert_exit(self.mesh_in_process(4, *options), 0)
        self.assertEqual(self.contents(4), by_mpi)

    @slow
    def test_virtual_clocks_agree_and_see_the_network(self):
        for network in [], ["--network", "1000,0.001"]:
            self.assert_exit(self.mesh_in_process(3, "--radius", 4, *network), 0)
        free, slow = ([rank["virtual"] for rank in json.loads(line)["ranks"]["by_rank"]]
                      for line in self.runs.read_text().splitlines())
        for ranks in free, slow:
            totals = [rank["computing_s"] + rank["waiting_s"] + rank["network_s"] for rank in ranks]
            self.assertLess(max(totals) - min(totals), 0.1)
            self.assertGreater(min(rank["computing_s"] for rank in ranks), 0)
        self.assertEqual({rank["network_s"] for rank in free}, {0})
        sent = [rank["bytes"] for rank in slow]
        self.assertEqual(sent, [rank["bytes"] for rank in free])
        for rank in slow:  # one MB/s, one ms per message
            self.assertGreater(rank["network_s"], max(sent) / 1e6)
            self.assertGreater(rank["network_s"], rank["messages"] / 3 * 1e-3)
        self.assertEqual(self.last_record()["ranks"]["network"], {"latency_us": 1000, "gigabytes_per_s": 0.001})

    @slow
    def test_virtual_threads_of_ranks_share_their_work(self):
        log = self.folder / "run.log"
        for threads in 1, 8:
            process = self.mesh_in_process(2, "--radius", 2, "--executor", "virtual", "--threads", threads,
                                           "--log", log, "--verify")
            self.assert_exit(process, 0)
            self.assert_exit(run_podm("replay", IMAGE, f"{log}.0", f"{log}.1"), 0)
        alone, together = (json.loads(line) for line in self.runs.read_text().splitlines())
        seconds = [max(rank["virtual"]["computing_s"] for rank in record["ranks"]["by_rank"])
                   for record in (alone, together)]
        self.assertLess(seconds[1], 0.6 * seconds[0])
        self.assertEqual({rank["threads"] for rank in together["ranks"]["by_rank"]}, {8})

    def test_what_is_refused(self):
        mesh = ["mesh", IMAGE, "-o", self.out]
        for arguments, words in ((["--network", "2,12.5"], ["--network", "--in-process"]),
                                 (["--in-process", 2, "--network", "2"], ["--network", "'2'", "US,GB/S"]),
                                 (["--in-process", 2, "--network", "0,1"], ["--network", "'0,1'"]),
                                 (["--in-process", 0], ["--in-process", "'0'"]),
                                 (["--in-process", 2, "--delta", 1000], ["--delta"]),
                                 (["--in-process", 2, "--optimize"], ["--optimize", "ranks"])):
            with self.subTest(arguments=arguments):
                process = self.assert_refused([*mesh, *arguments], *words, program=MPI_PROGRAM, env=ENVIRONMENT)
                self.assertEqual(process.stderr.count("podm-mpi: "), 1)
                self.assertNotIn("rank 0", process.stderr)
        self.assert_refused(["-n", 2, MPI_PROGRAM, *mesh, "--in-process", 2], "--in-process",
                            "2 processes", program=MPIRUN, env=ENVIRONMENT)

    def test_a_signal_ends_them_with_a_valid_mesh(self):
        process = start_podm("mesh", *ENDLESS, "-o", self.out, "--record", self.runs, "--in-process", 3,
                             program=MPI_PROGRAM, env=ENVIRONMENT)
        self.addCleanup(process.kill)
        self.assertTrue(any(line.startswith("refine") for line in process.stderr))
        time.sleep(2)  # rank 0 may be the last to begin
        process.send_signal(signal.SIGINT)
        stdout, stderr = process.communicate(timeout=120)
        self.assert_exit(subprocess.CompletedProcess([], process.returncode, stdout, stderr), 1)
        self.assertIn("ended early: cancelled", stderr)
        record = self.last_record()
        self.assertEqual(record["stop_reason"], "cancelled")
        self.assertEqual(self.out.exists(), record["cells"] > 0)
        if record["cells"]:
            self.assert_exit(run_podm(self.out, "--claims", "structure,delaunay,conformity", program=VERIFIER), 0)


class ByBricks(OnRanks):
    """Images whose voxels stay in the file."""

    def hash_of(self, image, *arguments, held, number=3):
        self.assert_exit(self.mesh(number, "--radius", 4, *arguments, image=image), 0)
        ranks = self.last_record()["ranks"]
        self.assertEqual(ranks["image"], held)
        self.assertEqual([rank["image_bytes_read"] > 0 for rank in ranks["by_rank"]], number * [held == "by bricks"])
        return ranks["mesh_hash"]

    def images(self):
        """Yields a file of each format with the same voxels."""
        size = 40
        voxels = ball_voxels(size)
        yield write_nifti(self.folder / "ball.nii", voxels, (size,) * 3)
        yield write_metaimage(self.folder / "ball.mha", voxels, size)
        yield write_nrrd(self.folder / "ball.nrrd", voxels, size, "uint8")
        (self.folder / "ball.raw").write_bytes(b"".join(bytes([0, voxel]) for voxel in voxels))
        header = self.folder / "ball.nhdr"
        header.write_text(f"NRRD0004\ntype: ushort\ndimension: 3\nsizes: {size} {size} {size}\nendian: big\n"
                          "encoding: raw\ndata file: ball.raw\n")
        yield header

    def test_they_make_the_mesh_of_ranks_that_hold_the_image(self):
        for image in few(self.images(), 2):
            with self.subTest(image=image.name):
                whole = self.hash_of(image, "--log", self.folder / "run.log", held="whole")
                self.assertEqual(self.hash_of(image, held="by bricks"), whole)
        self.assert_verifies(self.out, "--radius", 4, "--image", image)

    @slow
    def test_selections_and_r7(self):
        image = self.folder / "abdomen.nii"
        self.assert_exit(run_podm("phantom", "abdomen", "--size", 64, "-o", image), 0)
        for options in ["--labels", "1-3"], ["--merge", "1,2=both", "--drop", 3], ["--min-dihedral", 5]:
            with self.subTest(options=options):
                whole = self.hash_of(image, *options, "--log", self.folder / "run.log", held="whole")
                self.assertEqual(self.hash_of(image, *options, held="by bricks"), whole)

    @slow
    def test_one_that_no_process_may_hold(self):
        """A sparse file of 1500^3 voxels makes the mesh of its only part with labels."""
        length, size, corner = 1500, 96, (1368, 704, 1392)
        middle = (size - 1) / 2

        def label_at(*voxel):
            distance = sum((x - middle) ** 2 for x in voxel) ** 0.5
            return 0 if distance > 40 else 1 if distance > 20 else 2 + (voxel[0] > middle)

        voxels = voxels_of(size, label_at)
        with open(self.folder / "large.raw", "wb") as file:
            file.truncate(length ** 3)
            for row in range(size * size):
                y, z = corner[1] + row % size, corner[2] + row // size
                file.seek((z * length + y) * length + corner[0])
                file.write(voxels[size * row:size * (row + 1)])
        large = self.folder / "large.mhd"
        large.write_text(f"ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = {length} {length} {length}\n"
                         "ElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = large.raw\n")
        small = self.folder / "small.mha"
        header = ("ObjectType = Image\nNDims = 3\nBinaryData = True\n"
                  f"DimSize = {size} {size} {size}\nOffset = {corner[0]} {corner[1]} {corner[2]}\n"
                  "ElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n")
        small.write_bytes(header.encode() + voxels)
        records = []
        for image in large, small:
            process = run_podm("mesh", image, "-o", self.out, "--record", self.runs, "--in-process", 8, "--radius", 4,
                               program=MPI_PROGRAM, env=ENVIRONMENT)
            self.assert_exit(process, 0)
            self.assert_verifies(self.out, "--radius", 4, "--image", small)
            records.append(self.last_record())
        in_large, in_small = records
        self.assert_compressed_makes_the_same(large, in_large["ranks"]["mesh_hash"])
        self.assertEqual(in_large["ranks"]["image"], "by bricks")
        self.assertLess(in_large["peak_rss_bytes"], 2 * 2**30)
        self.assertLess(abs(in_large["cells"] / in_small["cells"] - 1), 0.02)
        process = run_podm("mesh", large, "-o", self.folder / "alone.vtu")
        self.assert_exit(process, 2)
        self.assertIn("large.mhd: the image is too large", process.stderr)

    def assert_compressed_makes_the_same(self, large, mesh_hash):
        """`large` is a MetaImage. The same voxels in a .nii.gz have the same position."""
        image = self.folder / "large.nii.gz"
        length = 1500
        affine = ((-1, 0, 0, 0), (0, -1, 0, 0), (0, 0, 1, 0))
        with gzip.open(image, "wb", compresslevel=1) as file, open(large.with_suffix(".raw"), "rb") as voxels:
            file.write(nifti_bytes(b"", (length,) * 3, affine=affine))
            shutil.copyfileobj(voxels, file, 1 << 24)
        process = run_podm("mesh", image, "-o", self.out, "--record", self.runs, "--in-process", 8, "--radius", 4,
                           program=MPI_PROGRAM, env=ENVIRONMENT)
        self.assert_exit(process, 0)
        self.assertEqual(self.last_record()["ranks"]["mesh_hash"], mesh_hash)

    def test_faults_are_refused_by_all(self):
        voxels = bytearray(ball_voxels(12))
        voxels[-1] = 0xff  # -1
        faulty = write_nifti(self.folder / "faulty.nii", bytes(voxels), datatype=INT8)
        short = write_nifti(self.folder / "short.nii", bytes(voxels[:-1]))
        for image, *words in (faulty, "(11, 11, 11) is -1", "no label"), (short, "truncated"):
            with self.subTest(image=image.name):
                process = self.mesh(2, image=image)
                self.assert_exit(process, 2)
                for word in (image.name, *words):
                    self.assertIn(word, process.stderr)
                self.assertFalse(self.out.exists())


class Logs(OnRanks):
    def setUp(self):
        super().setUp()
        self.log = self.folder / "run.log"

    def logs(self, number):
        return [self.log] if number == 1 else [self.folder / f"run.log.{i}" for i in range(number)]

    def assert_replays(self, logs):
        process = run_podm("replay", IMAGE, *logs)
        self.assert_exit(process, 0)
        self.assertEqual(process.stderr.count(self.last_record()["ranks"]["mesh_hash"]), 2)
        if len(logs) > 1:
            self.assert_replays_on_ranks(len(logs))

    def assert_replays_on_ranks(self, number):
        replay = [MPI_PROGRAM, "replay", IMAGE, self.log]
        in_process = run_podm(*replay[1:], "--in-process", number, program=MPI_PROGRAM, env=ENVIRONMENT)
        for process in in_process, self.mpirun("-n", number, *replay):
            self.assert_exit(process, 0)
            self.assertEqual(process.stderr.count(self.last_record()["ranks"]["mesh_hash"]), 2)
            self.assertIn("the run equals its replay", process.stderr)

    def test_the_logs_of_all_ranks_replay_to_their_mesh(self):
        for number, threads, space in (1, 2, "RAS"), (2, 1, "voxel"), (4, 2, "LPS"):
            with self.subTest(ranks=number, threads=threads):
                self.assert_exit(self.mesh(number, "--radius", 3.5, "--log", self.log, "--threads", threads, "--space",
                                           space, "--oversubscribe"), 0)
                logs = self.logs(number)
                self.assertLessEqual({log.name for log in logs}, self.names())
                self.assert_replays(logs[::-1])
                for log in logs:
                    log.unlink()

    def test_the_logs_of_a_target_are_those_of_its_last_mesh(self):
        process = self.mesh_in_process(3, "--target-elements", 20000, "--target-tolerance", 0.5, "--log", self.log)
        self.assert_exit(process, 0)
        record = self.last_record()
        self.assertGreater(len(record["calibration"]["meshes"]), 0)
        self.assertLess(abs(record["cells"] / 20000 - 1), 0.005)
        self.assert_replays(self.logs(3))

    def test_a_run_that_is_stopped_equals_its_replay(self):
        for most in 6000, 60000:  # with coarser seeds, and without
            self.assert_exit(self.mesh(3, "--radius", 1, "--log", self.log, "--max-elements", most), 1)
            self.assert_replays(self.logs(3))

    @slow
    def test_logs_are_needed_all_and_of_one_run(self):
        for number, radius in (2, 3), (3, 4):
            self.log = self.folder / f"on_{number}.log"
            self.assert_exit(self.mesh(number, "--radius", radius, "--log", self.log), 0)
        one, other = ([self.folder / f"on_{number}.log.{i}" for i in range(number)] for number in (2, 3))
        for logs, *words in ((other[1:], other[1], "rank 0 of 3 is missing"),
                             (one[:1], one[0], "rank 1 of 2 is missing"),
                             ([*one, one[0]], one[0], "rank 0 of 2"),
                             ([one[0], other[1]], other[1], "of another run")):
            self.assert_refused(["replay", IMAGE, *logs], *words)
        self.assert_refused(["replay", "phantom:spheres@31", *one], one[0], "another image")
        for arguments, *words in ((["on_3.log", "--in-process", 2], "rank 0 of 3"),
                                  (["on_2.log", "--in-process", 3], "on_2.log.2", "cannot be opened"),
                                  (["no.log", "--in-process", 2], "no.log.0", "cannot be opened"),
                                  (["on_2.log"], "one rank cannot replay"), (["on_2.log", "--in-process", 1], "'1'")):
            self.assert_refused(["replay", IMAGE, self.folder / arguments[0], *arguments[1:]], *words,
                                program=MPI_PROGRAM, env=ENVIRONMENT)

    def test_a_mesh_that_ranks_did_not_make_differs(self):
        self.assert_exit(self.mesh(2, "--radius", 4, "--log", self.log), 0)
        for log in self.logs(2):
            head = f'"mesh_hash":"{self.last_record()["ranks"]["mesh_hash"]}"'.encode()
            self.assertIn(head, log.read_bytes())
            log.write_bytes(log.read_bytes().replace(head, b'"mesh_hash":"0123456789abcdef"'))
        process = run_podm("replay", IMAGE, *self.logs(2))
        self.assert_exit(process, 1)
        self.assertIn("does not equal its replay", process.stderr)
        process = run_podm("replay", IMAGE, self.log, "--in-process", 2, program=MPI_PROGRAM, env=ENVIRONMENT)
        self.assert_exit(process, 1)
        self.assertIn("does not equal its replay", process.stderr)

    def test_a_disk_that_is_full_for_one_rank_leaves_no_log(self):
        mesh = [MPI_PROGRAM, "mesh", IMAGE, "-o", self.out, "--radius", 2, "--quiet", "--log", self.log]
        process = self.mpirun("-n", 1, *mesh, ":", "-n", 1, "sh", "-c",
                              f'{FULL_DISK}; exec "$0" "$@"', *mesh)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("podm-mpi: rank 1 of 2: cannot write", process.stderr)
        self.assertIn("run.log.1", process.stderr)
        self.assertEqual({name for name in self.names() if ".tmp" not in name}, set())


class Refusals(OnRanks):
    def assert_all_refuse(self, arguments, *words):
        before = self.files()
        process = self.mpirun(*arguments)
        self.assert_exit(process, 2)
        errors = [line for line in process.stderr.splitlines() if line.startswith("podm-mpi: ")]
        self.assertEqual(len(errors), 1, process.stderr)
        for word in words:
            self.assertIn(str(word), errors[0])
        self.assertEqual(self.files(), before)

    def test_what_ranks_do_not_have_yet(self):
        for option, *words in (["--optimize", "--optimize"], ["--algorithm", "podm-home", "algorithm podm-home"],
                               ["--schedule", self.folder / "leaves.jsonl", "--schedule"]):
            *values, word = words
            with self.subTest(option=option):
                self.assert_all_refuse(["-n", 2, MPI_PROGRAM, "mesh", IMAGE, "-o", self.out, option,
                                        *values], word, "not available on ranks")

    def test_ranks_of_mpi_have_no_virtual_time(self):
        self.assert_all_refuse(["-n", 2, MPI_PROGRAM, "mesh", IMAGE, "-o", self.out, "--executor",
                                "virtual"], "virtual time", "--in-process")

    def test_faults_that_every_rank_sees_are_printed_once(self):
        mesh = ["-n", 3, MPI_PROGRAM, "mesh"]
        self.assert_all_refuse([*mesh, IMAGE, "-o", self.folder / "out.vtu"], "out.vtu", ".pvtu")
        self.assert_all_refuse([*mesh, IMAGE, "-o", self.folder / "none" / "out.pvtu"], "none/out.pvtu")
        self.assert_all_refuse([*mesh, IMAGE, "-o", self.out, "--log", self.folder / "none" / "run.log"],
                               "rank 0 of 3", "none/run.log.0")
        self.assert_all_refuse([*mesh, self.folder / "none.nii", "-o", self.out], "none.nii")
        self.assert_all_refuse([*mesh, IMAGE, "-o", self.out, "--radios", 3], "unknown option '--radios'")
        self.assert_all_refuse([*mesh, IMAGE, "-o", self.out, "--target-elements", 100, "--size-near", "1,0=1:3"],
                               "a target of 100 elements")
        self.assert_all_refuse([*mesh, IMAGE, "-o", self.out, "--radius", 3, "--delta", 1000], "--delta")

    def test_ranks_that_do_not_ask_for_the_same(self):
        one, other = (write_nifti(self.folder / f"{name}.nii", ball_voxels(size), (size,) * 3)
                      for name, size in (("one", 12), ("other", 13)))
        mesh = ["mesh", one, "-o", self.out]
        for arguments, word in ((["mesh", other, "-o", self.out], "image"),
                                ([*mesh, "--radius", 3], "radius"),
                                ([*mesh, "--algorithm", "pdr"], "algorithm"),
                                ([*mesh, "--leaf-size", 3], "leaf size"),
                                (["mesh", one, "-o", self.folder / "b.pvtu"], "output"),
                                ([*mesh, "--log", self.folder / "run.log"], "--log"),
                                ([*mesh, "--no-such"], "rank 1 of 2: unknown option"),
                                (["--help"], "command")):
            with self.subTest(word=word):
                self.assert_all_refuse(on_ranks(mesh, arguments), word)

    def test_a_disk_that_is_full_for_one_rank(self):
        """All ranks report the reason and end; the earlier files stay."""
        self.assert_exit(self.mesh(2, "--radius", 6), 0)
        mesh = ["mesh", IMAGE, "-o", self.out, "--radius", 2, "--quiet"]
        self.assert_all_refuse(["-n", 1, MPI_PROGRAM, *mesh, ":", "-n", 1, "sh", "-c",
                                f'{FULL_DISK}; exec "$0" "$@"', MPI_PROGRAM, *mesh],
                               "rank 1 of 2", "cannot write", "out_1")
        self.assert_verifies(self.out)


class JsonProgress(OnRanks):
    def test_the_first_rank_reports(self):
        for arguments in ["-n", 2, MPI_PROGRAM, "mesh"], ["-n", 1, MPI_PROGRAM, "mesh", "--in-process", 2]:
            process = self.mpirun(*arguments, IMAGE, "-o", self.out, "--radius", 3, "--quiet", "--json-progress")
            self.assert_exit(process, 0)
            phases = [json.loads(line)["phase"] for line in process.stdout.splitlines()]
            self.assertEqual(phases.count("transform"), 1)
            self.assertLessEqual({"transform", "refine", "extract", "measure"}, set(phases))


class Vtkhdf(OnRanks):
    def read(self, path):
        """Returns the grid of a file as VTK reads it, with a volume or area per cell."""
        import vtk
        reader, sizes = vtk.vtkHDFReader(), vtk.vtkCellSizeFilter()
        reader.SetFileName(str(path))
        sizes.SetInputConnection(reader.GetOutputPort())
        sizes.Update()
        return sizes.GetOutput()

    def test_vtk_reads_cells_and_facets_of_all_ranks(self):
        try:
            import vtk
            from vtkmodules.util.numpy_support import vtk_to_numpy
        except ImportError:
            self.skipTest("needs the package python3-vtk9")
        out = self.folder / "out.vtkhdf"
        self.assert_exit(self.mesh(3, "--radius", 3, out=out), 0)
        record = self.last_record()
        cells, facets = self.read(out), self.read(self.folder / "out_facets.vtkhdf")
        self.assertEqual((cells.GetNumberOfCells(), cells.GetCellType(0)), (record["cells"], vtk.VTK_TETRA))
        self.assertEqual(facets.GetNumberOfCells(), record["boundary_facets"])
        labels, volumes = (vtk_to_numpy(cells.GetCellData().GetArray(name)) for name in ("label", "Volume"))
        for label in record["labels"]:
            self.assertEqual((labels == label["value"]).sum(), label["cells"])
            self.assertAlmostEqual(volumes[labels == label["value"]].sum() / label["volume_mm3"], 1, places=9)
        ids = vtk_to_numpy(cells.GetPointData().GetArray("GlobalNodeIds"))
        self.assertEqual((len(set(ids)), ids.max() + 1), (record["vertices"],) * 2)
        names = cells.GetFieldData().GetAbstractArray("label_name")
        self.assertEqual(names.GetValue(0), "outside")
        self.assert_refuses_verify(out)

    def assert_refuses_verify(self, out):
        process = self.mesh(2, "--radius", 3, "--verify", out=out)
        self.assert_exit(process, 2)
        self.assertIn("podm-verify does not read", process.stderr)


class Resumed(OnRanks):
    def setUp(self):
        super().setUp()
        self.saved = self.folder / "saved"
        self.image = self.folder / "spheres.nii.gz"
        self.assert_exit(run_podm("phantom", "spheres", "--size", 32, "-o", self.image), 0)

    def saving(self, number, *arguments, resume=False):
        return self.mesh(number, "--radius", 3, "--checkpoint", self.saved, *arguments, *["--resume"] * resume,
                         image=self.image)

    def begin(self, *arguments):
        process = self.saving(2, "--max-elements", 6000, *arguments)
        self.assert_exit(process, 1)
        self.assertIsNone(self.last_record()["ranks"]["resumed"])
        self.assertIn("checkpoint.txt", {path.name for path in self.saved.iterdir()})

    def assert_refuses(self, process, *words):
        self.assert_exit(process, 2)
        for word in words:
            self.assertIn(word, process.stderr)

    def test_another_number_of_ranks_ends_the_mesh(self):
        self.begin()
        for number in few((3, 1, 2), 1):
            with self.subTest(ranks=number):
                self.assert_exit(self.saving(number, resume=True), 0)
                self.assertEqual(self.last_record()["stop_reason"], "complete")
                self.assertEqual(self.last_record()["ranks"]["resumed"], {"rounds": 1, "ranks": 2})
                self.assert_verifies(self.out, "--radius", 3, "--image", self.image)
                self.begin()

    @slow
    def test_leaves_and_r7_resume(self):
        for options in ["--algorithm", "pdr", "--threads", 2, "--oversubscribe"], ["--min-dihedral", 8]:
            self.begin(*options)
            self.assert_exit(self.saving(3, *options, "--checkpoint-seconds", 1e-6, resume=True), 0)
            self.assert_verifies(self.out, "--radius", 3, "--image", self.image)

    def test_a_run_that_is_killed_resumes(self):
        command = [MPI_PROGRAM, "mesh", self.image, "--radius", 1.2, "--in-process", 3, "-o", self.out, "--checkpoint",
                   self.saved, "--checkpoint-seconds", 1e-6, "--quiet"]
        with subprocess.Popen([str(word) for word in command], env=ENVIRONMENT) as process:
            for _ in range(600):
                if (self.saved / "checkpoint.txt").exists():
                    break
                time.sleep(0.1)
            process.kill()
        self.assertFalse(self.out.exists())
        self.assert_exit(self.mesh_of("--radius", 1.2, "--in-process", 4, "--checkpoint", self.saved, "--resume"), 0)
        self.assert_verifies(self.out, "--radius", 1.2, "--image", self.image)

    def mesh_of(self, *arguments):
        return run_podm("mesh", self.image, "-o", self.out, "--record", self.runs, *arguments, program=MPI_PROGRAM,
                        env=ENVIRONMENT)

    def test_what_is_refused(self):
        self.assert_refuses(self.saving(2, resume=True), "saved: the folder has no whole checkpoint")
        self.assert_refuses(self.saving(1), "use more ranks")
        self.begin()
        self.assert_refuses(self.saving(2, "--smooth", 1, resume=True),
                            "checkpoint.txt: the checkpoint does not have the smoothing of this run: 0 mm, not 1 mm")
        self.assert_refuses(self.mesh(2, "--radius", 3, "--checkpoint", self.saved, "--resume"),
                            "checkpoint.txt: the checkpoint does not have the")
        self.assert_refuses(self.saving(2, "--log", self.folder / "run.log", resume=True), "--resume", "--log")
        self.assert_refuses(self.mesh(2, "--resume"), "--resume", "--checkpoint")
        piece = next(self.saved.glob("vertices_*_1.bin"))
        piece.write_bytes(piece.read_bytes()[:-1])
        self.assert_refuses(self.saving(3, resume=True), piece.name, "bytes, not")

    def test_a_full_disk_leaves_the_last_checkpoint(self):
        self.begin()
        before = {path: path.read_bytes() for path in self.saved.iterdir()}
        mesh = [MPI_PROGRAM, "mesh", self.image, "-o", self.out, "--radius", 3, "--quiet", "--checkpoint", self.saved,
                "--checkpoint-seconds", 1e-6]
        process = self.mpirun("-n", 1, *mesh, ":", "-n", 1, "sh", "-c", f'{FULL_DISK}; exec "$0" "$@"', *mesh)
        self.assert_refuses(process, "rank 1 of 2: cannot write", "vertices_")
        self.assertEqual({path: path.read_bytes() for path in self.saved.iterdir()}, before)
        self.assert_exit(self.saving(3, resume=True), 0)


class EarlyEnds(OnRanks):
    def assert_ended_early(self, process, reason):
        self.assert_exit(process, 1)
        self.assertIn(f"ended early: {reason}", process.stderr)
        self.assertEqual(self.last_record()["stop_reason"], reason)
        report = run_podm(self.out, "--claims", "structure,delaunay,conformity", program=VERIFIER)
        self.assert_exit(report, 0)

    def test_time_limit(self):
        self.assert_ended_early(self.mesh(2, *ENDLESS[1:], "--max-seconds", 2, image=ENDLESS[0]), "time limit")

    def test_element_limit_is_shared(self):
        self.assert_ended_early(self.mesh(3, *ENDLESS[1:], "--max-elements", 60000, image=ENDLESS[0]), "element limit")
        self.assertLessEqual(self.last_record()["cells"], 60000)
        self.assertGreater(self.last_record()["cells"], 30000)

    @slow
    def test_seeds_are_not_measured_by_one_ranks_share(self):
        self.assert_exit(self.mesh_in_process(64, "--radius", 8, "--max-elements", 60000), 0)
        self.assertLess(self.last_record()["cells"], 60000)

    def start(self, number, mesh=ENDLESS):
        command = [MPIRUN, "-n", str(number), MPI_PROGRAM, "mesh", *map(str, mesh),
                   "-o", self.out, "--record", self.runs]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
        self.addCleanup(process.kill)
        for line in process.stderr:
            share = re.match(r"refine +(\d+) %", line)
            if share and int(share[1]) >= 10:  # all ranks refine
                ranks = ranks_below(process.pid)
                self.assertEqual(len(ranks), number)
                return process, ranks
        self.fail(f"no refinement: exit {process.wait()}")

    def test_a_lack_of_memory_of_one_rank_ends_all(self):
        """Within the limit of address space a rank makes less than its part, or nothing."""
        mesh = [MPI_PROGRAM, "mesh", *ENDLESS, "-o", self.out, "--record", self.runs, "--quiet"]
        ends = set()
        for kib in few((250_000, 350_000, 500_000, 700_000), 2):
            self.out.unlink(missing_ok=True)
            process = self.mpirun("-n", 1, *mesh, ":", "-n", 1, "sh", "-c", f'ulimit -v {kib}; exec "$0" "$@"', *mesh)
            ends.add(process.returncode)
            if process.returncode == 1:
                self.assert_ended_early(process, "memory limit")
                self.assertRegex(process.stderr, "warning: memory ended the run; [0-9]+ or more ranks")
            else:
                self.assert_exit(process, 3)
                self.assertRegex(process.stderr, "rank 1 of 2: out of memory(: .* [0-9]+ or more ranks)?")
                self.assertFalse(self.out.exists())
        self.assertIn(3, ends)

    def wait_for_end(self, process):
        """Waits until the process has ended, also if no parent has collected its status."""
        stat = pathlib.Path(f"/proc/{process}/stat")
        for _ in range(100):
            if not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] in "ZX":
                return
            time.sleep(0.1)
        self.fail(f"process {process} goes on")

    def test_a_rank_that_is_killed_ends_all_and_nothing_is_written(self):
        for which in few((2, 0), 1):
            process, ranks = self.start(3)
            os.kill(ranks[which], signal.SIGKILL)
            process.communicate(timeout=60)
            self.assertNotEqual(process.returncode, 0)
            self.assertEqual(self.names() - {"runs.jsonl"}, set())
            for rank in ranks:
                self.wait_for_end(rank)

    def test_a_signal_to_one_rank_ends_all_in_their_first_round(self):
        process, ranks = self.start(3, LONGER)
        os.kill(ranks[1], signal.SIGTERM)
        stdout, stderr = process.communicate(timeout=120)
        self.assert_ended_early(subprocess.CompletedProcess([], process.returncode, stdout, stderr), "cancelled")
        first, = self.last_record()["ranks"]["rounds"]
        self.assertLess(first["insertions"], 2_000_000, "each of three ranks would make 1,070,000")

    @slow
    def test_a_signal_to_all_ranks_ends_them_with_a_valid_mesh(self):
        process, ranks = self.start(2)
        for rank in ranks:
            os.kill(rank, signal.SIGTERM)
        stdout, stderr = process.communicate(timeout=120)
        self.assert_ended_early(subprocess.CompletedProcess([], process.returncode, stdout, stderr), "cancelled")


if __name__ == "__main__":
    unittest.main()
