"""Runs the podm program as a user does, and reads its output. The program's path is in $PODM_PROGRAM."""

import collections
import json
import os
import pathlib
import signal
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["PODM_PROGRAM"]
TIMEOUT_S = 240


def run_podm(*arguments, program=PROGRAM, **popen_options):
    """Returns the finished process, with text in stdout and stderr."""
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=TIMEOUT_S,
                          **popen_options)


def start_podm(*arguments, program=PROGRAM, **popen_options):
    """Returns a running process with the default action for signals, independent of this process's settings."""
    def defaults():
        for number in signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT:
            signal.signal(number, signal.SIG_DFL)
    return subprocess.Popen([program, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            text=True, **{"preexec_fn": defaults, **popen_options})


class PodmTestCase(unittest.TestCase):
    """A test with a folder of its own, and the assertions that tests of all commands share."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def assert_exit(self, process, code):
        self.assertEqual(process.returncode, code, process.stdout + process.stderr)

    def assert_refused(self, arguments, *words, **popen_options):
        """Checks for exit code 2, an empty standard output, every word in the message, and no new or changed file."""
        before = self.files()
        process = run_podm(*arguments, **popen_options)
        self.assert_exit(process, 2)
        self.assertEqual(process.stdout, "")
        for word in words:
            self.assertIn(str(word), process.stderr)
        self.assertEqual(self.files(), before)
        return process

    def files(self):
        return {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}

    def read_record(self, path):
        lines = pathlib.Path(path).read_text().splitlines()
        self.assertEqual(len(lines), 1)
        return json.loads(lines[0])

    def assert_valid_mesh(self, path):
        """Checks that cells exist and are positive, that at most two cells share a facet, and that exactly the facets
        at changes of labels are tagged."""
        mesh = read_medit(path)
        self.assertGreater(len(mesh.cells), 0)
        around = collections.defaultdict(list)
        for *cell, label in mesh.cells:
            self.assertGreater(volume(*(mesh.vertices[v] for v in cell)), 0)
            for opposite in range(4):
                around[frozenset(cell[:opposite] + cell[opposite + 1:])].append(label)
        self.assertLessEqual(max(map(len, around.values())), 2)
        changes = {facet for facet, labels in around.items() if len(labels) == 1 or labels[0] != labels[1]}
        self.assertEqual({frozenset(facet[:3]) for facet in mesh.facets}, changes)
        self.assertEqual(len(mesh.facets), len(changes))
        return mesh


Mesh = collections.namedtuple("Mesh", "vertices cells facets")


def read_medit(path):
    """Returns vertices by number from 1, and cells and facets as vertex numbers with the reference last."""
    with open(path) as file:
        words = [word for line in file if not line.lstrip().startswith("#") for word in line.split()]

    def block(name, width, number):
        at = words.index(name) + 1
        count = int(words[at])
        entries = words[at + 1:at + 1 + count * width]
        return [tuple(map(number, entries[i:i + width])) for i in range(0, count * width, width)]

    vertices = {i: tuple(xyz[:3]) for i, xyz in enumerate(block("Vertices", 4, float), 1)}
    return Mesh(vertices, block("Tetrahedra", 5, int), block("Triangles", 4, int))


def volume(a, b, c, d):
    u, v, w = ([q[i] - a[i] for i in range(3)] for q in (b, c, d))
    return (w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
            w[2] * (u[0] * v[1] - u[1] * v[0])) / 6
