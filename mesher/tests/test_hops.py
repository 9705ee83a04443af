"""Accesses by kind and distance of virtual workers on a described machine, as the record lists them."""

import json
import os

from podm_process import PodmTestCase, run_podm

IMAGE = "phantom:abdomen@40"
BLACKLIGHT = os.path.join(os.path.dirname(__file__), "../../experiments/machines/blacklight.toml")
TWO_NODES = """<topology version="2.0">
  <object type="Machine" os_index="0" cpuset="0xf" complete_cpuset="0xf" nodeset="0x3" complete_nodeset="0x3">
    <object type="Package" os_index="0" cpuset="0x3" complete_cpuset="0x3" nodeset="0x1" complete_nodeset="0x1">
      <object type="NUMANode" os_index="0" cpuset="0x3" complete_cpuset="0x3" nodeset="0x1" complete_nodeset="0x1"/>
      <object type="PU" os_index="0" cpuset="0x1" complete_cpuset="0x1" nodeset="0x1" complete_nodeset="0x1"/>
      <object type="PU" os_index="1" cpuset="0x2" complete_cpuset="0x2" nodeset="0x1" complete_nodeset="0x1"/>
    </object>
    <object type="Package" os_index="1" cpuset="0xc" complete_cpuset="0xc" nodeset="0x2" complete_nodeset="0x2">
      <object type="NUMANode" os_index="1" cpuset="0xc" complete_cpuset="0xc" nodeset="0x2" complete_nodeset="0x2"/>
      <object type="PU" os_index="2" cpuset="0x4" complete_cpuset="0x4" nodeset="0x2" complete_nodeset="0x2"/>
      <object type="PU" os_index="3" cpuset="0x8" complete_cpuset="0x8" nodeset="0x2" complete_nodeset="0x2"/>
    </object>
  </object>
</topology>
"""
KINDS = "mesh_reads", "mesh_writes", "image_reads", "transform_reads"


class Hops(PodmTestCase):
    def mesh(self, *arguments, sizes=("--radius", 12)):
        runs = self.folder / "runs.jsonl"
        process = run_podm("mesh", IMAGE, *sizes, "-o", self.folder / "out.vtu", "--record", runs,
                           "--oversubscribe", *arguments)
        self.assert_exit(process, 0)
        return json.loads(runs.read_text().splitlines()[-1])

    def mesh_on_blades(self, *arguments, **sizes):
        return self.mesh("--executor", "virtual", "--topology", BLACKLIGHT, "--pin", "compact", "--threads", 32,
                         *arguments, **sizes)

    def test_every_kind_is_counted_by_distance(self):
        for algorithm in "podm", "pdr", "pdr-podm":
            with self.subTest(algorithm=algorithm):
                record = self.mesh_on_blades("--algorithm", algorithm)
                kinds = record["hops_by_kind"]
                self.assertEqual(set(kinds), set(KINDS))
                self.assertEqual(record["hops"], kinds["mesh_reads"])
                for kind in KINDS:
                    self.assertEqual(len(kinds[kind]), 4, "0 to 3 hops")
                    self.assertGreater(kinds[kind][0], 0)
                    self.assertGreater(sum(kinds[kind][1:]), 0, "32 workers are on two blades")
                    of_workers = [worker["hops_by_kind"][kind] for worker in record["workers"]]
                    self.assertEqual(kinds[kind], [sum(counts) for counts in zip(*of_workers)])

    def test_counts_are_the_same_for_the_same_seed(self):
        first, again, other = (self.mesh_on_blades("--seed", seed)["hops_by_kind"] for seed in (3, 3, 4))
        self.assertEqual(first, again)
        self.assertNotEqual(first, other)

    def test_meshes_of_a_radius_search_leave_the_next_no_caches(self):
        searched = self.mesh_on_blades(sizes=("--target-elements", 8000, "--target-tolerance", 0.1))
        self.assertGreater(len(searched["calibration"]["meshes"]), 0, "a mesh missed the target before the last")
        used = searched["used"]
        alone = self.mesh_on_blades(sizes=("--radius", used["radius_mm"], "--delta", used["delta_mm"]))
        for name in "mesh_sha256", "hops_by_kind":
            self.assertEqual(searched[name], alone[name], name)
        self.assertEqual(searched["virtual"]["refine_s"], alone["virtual"]["refine_s"])

    def test_counting_changes_no_mesh(self):
        # Memory of an hwloc machine costs virtual workers nothing. Workers that beg at random act alike at any place,
        # counted or not.
        machine = self.folder / "two_nodes.xml"
        machine.write_text(TWO_NODES)
        virtual = "--executor", "virtual", "--threads", 4, "--begging", "random"
        uncounted = self.mesh(*virtual, "--pin", "none")
        counted = self.mesh(*virtual, "--pin", "compact", "--topology", machine)
        self.assertEqual(counted["mesh_sha256"], uncounted["mesh_sha256"])
        self.assertEqual(len(counted["hops"]), 2)
        self.assertGreater(counted["hops"][1], 0)

    def test_what_cannot_be_counted_says_why(self):
        record = self.mesh("--threads", 1)
        self.assertEqual(record["hops"], "unavailable: one NUMA node or one thread")
        self.assertEqual(record["hops_by_kind"], record["hops"])
        self.assertEqual(record["workers"][0]["hops_by_kind"], record["hops"])
        self.assertEqual(self.mesh_on_blades()["pages"], "unavailable: the machine is described by a file")
