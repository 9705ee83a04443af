"""What the adapters of CGAL's mesh generation share: images and meshes to and from cgal_mesh3 and its likes, programs
beside podm (GPL-3.0-or-later, built by `make peers`).

The radius is CGAL's cell_size, delta its facet_size; facet angle 30 degrees and radius-edge ratio 1.93 are as podm's.
Lines, which CGAL detects, have edges of at most 1.25 delta, as podm's have.
CGAL reads INR, so a NIfTI image is rewritten, and the mesh is taken to the image's own frame.
"""
import gzip
import json
import os
import re
import shutil
import subprocess
import sys

import adapter
import numpy as np

NIFTI_TYPES = {2: "u1", 4: "i2", 8: "i4", 256: "i1", 512: "u2", 768: "u4"}
HEADER_BYTES = 256  # of an INR file, or a multiple
LINES_DELTA = 1.25  # podm's sampling distance of lines, times delta
DETECTS_LINES = (5, 6)  # the first version of CGAL that does


def version_of(program):
    """The adapter's answer to --version."""
    def version(options):
        path = path_of(program, options)
        if not os.access(path, os.X_OK):
            adapter.absent(why_not_built(program))
        return subprocess.run([path, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    return version


def detects_lines(version):
    return tuple(map(int, re.match(r"CGAL (\d+)\.(\d+)", version).groups())) >= DETECTS_LINES


def why_not_built(program):
    if program.startswith("cgal6"):
        return "CGAL 6 headers were not given: make peers CGAL6=FOLDER"
    return f"{program} is not built beside podm: make peers"


def path_of(program, options):
    return os.path.join(os.path.dirname(os.path.abspath(options.podm)), program)


def read_nifti(path):
    """Labels, first axis fastest, and how many along each axis."""
    if not path.endswith((".nii", ".nii.gz")):
        adapter.refuse("CGAL is given NIfTI and INR images")
    with (gzip.open if path.endswith(".gz") else open)(path, "rb") as file:
        data = file.read()
    order = "<" if data[:4] == (348).to_bytes(4, "little") else ">"
    size = np.frombuffer(data, order + "i2", 3, 42)
    kind = int(np.frombuffer(data, order + "i2", 1, 70)[0])
    if kind not in NIFTI_TYPES:
        adapter.refuse("CGAL is given NIfTI images of integer labels")
    begin = int(np.frombuffer(data, order + "f4", 1, 108)[0])
    return np.frombuffer(data, order + NIFTI_TYPES[kind], int(np.prod(size.astype(int))), begin), size


def write_inr(path, labels, size, spacing_mm):
    if labels.min() < 0 or labels.max() > 0xFFFF:
        adapter.refuse("CGAL is given labels of 0..65535")
    header = "#INRIMAGE-4#{\n" + "".join(f"{axis}DIM={n}\n" for axis, n in zip("XYZ", size)) + "VDIM=1\n"
    header += "".join(f"V{axis}={mm!r}\n" for axis, mm in zip("XYZ", spacing_mm))
    header += "TYPE=unsigned fixed\nPIXSIZE=16 bits\nSCALE=2**0\nCPU=decm\n"
    with open(path, "wb") as file:
        file.write((header + "\n" * (HEADER_BYTES - 4 - len(header)) + "##}\n").encode())
        file.write(labels.astype("<u2").tobytes())


def move_to_frame(path, moved_path, spacing_mm, affine):
    """Rewrites the vertices of a Medit file: millimetres from the first voxel become the image's frame."""
    matrix = np.array(affine)
    with open(path) as file, open(moved_path, "w") as moved:
        for line in file:
            moved.write(line)
            if line.strip() == "Vertices":
                break
        count = file.readline()
        moved.write(count)
        vertices = np.array([file.readline().split()[:3] for _ in range(int(count))], float)
        for x, y, z in (vertices / spacing_mm @ matrix[:, :3].T + matrix[:, 3]).tolist():
            moved.write(f"{x!r} {y!r} {z!r} 0\n")
        moved.writelines(file)


def write_image(path, options, info):
    """The image as INR, which CGAL reads gzipped too."""
    if options.image.endswith((".inr", ".inr.gz")):
        path += ".gz" if options.image.endswith(".gz") else ""
        shutil.copyfile(options.image, path)
    else:
        write_inr(path, *read_nifti(options.image), info["spacing_mm"])
    return path


PROMISES = ("structure", "delaunay", "radius_edge", "size", "conformity")
# Exuding gives vertices weights, and so does the protection of lines by balls. CGAL's other bounds do not hold then.
PROMISES_WITH_WEIGHTS = ("structure", "conformity")


def run(program, sequential, parallel, optimisers=(), promises=PROMISES):
    """The adapter, on CGAL's Sequential_tag for one thread unless it is parallel alone. `optimisers`, perturb and
    exude, follow on refinement, and void promises."""
    options = adapter.parse_arguments(version_of(program), keeps_lines=True)
    if options.lines and not detects_lines(version_of(program)(options)):
        adapter.refuse("CGAL before 5.6 detects no lines in images")
    if options.threads > 1 and not parallel:
        sys.exit("a sequential mesher: threads = 1")
    threads = 0 if sequential and options.threads == 1 else options.threads
    inside = lambda name: os.path.join(options.output, name)
    info = json.loads(subprocess.run([options.podm, "info", options.image, "--json"], check=True,
                                     capture_output=True).stdout)
    switches = ["--threads", str(threads)]
    for switch, bound in (("--cell-size", options.radius), ("--facet-size", options.delta)):
        switches += [switch, repr(bound)] if bound else []
    if options.lines:
        switches += ["--lines"] + (["--edge-size", repr(LINES_DELTA * options.delta)] if options.delta else [])
    switches += ["--" + optimiser for optimiser in optimisers]
    log, _, peak_rss_bytes = adapter.run([path_of(program, options), write_image(inside("image.inr"), options, info),
                                          *switches, "--output", inside("voxels.mesh")], inside("cgal.log"))
    measured = json.loads(log.splitlines()[-1])
    move_to_frame(inside("voxels.mesh"), inside("mesh.mesh"), info["spacing_mm"], info["affine"])
    phases_s = {"read": measured["read_seconds"], "prepare": measured["prepare_seconds"],
                "refine": measured["seconds"], **{name: measured[f"{name}_seconds"] for name in optimisers}}
    adapter.write_record(options.output, mesh="mesh.mesh", cells=measured["cells"], vertices=measured["vertices"],
                         boundary_facets=measured["boundary_facets"], phases_s=phases_s,
                         peak_rss_bytes=peak_rss_bytes, threads={"asked": options.threads, "used": options.threads},
                         options={"switches": switches, "queue": measured["options"]["queue"],
                                  "cgal": measured["options"]["cgal"]},
                         promises=list(PROMISES_WITH_WEIGHTS if options.lines else promises))
