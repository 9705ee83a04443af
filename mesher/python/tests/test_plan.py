"""podm.plan predicts what podm.mesh makes."""

import unittest
import warnings

import numpy as np

import podm


class Plan(unittest.TestCase):
    def test_cells_are_those_of_the_mesh_and_islands_can_be_dropped(self):
        labels = np.zeros((30, 30, 30), np.uint8)
        labels[4:26, 4:26, 4:26] = 1
        labels[12:18, 12:18, 12:18] = 2
        labels[1, 1, 1] = 2
        options = {"spacing": (0.5, 1, 1), "radius": 1.5, "names": {2: "core"}, "threads": 1}
        plan = podm.plan(labels, **options)
        mesh = podm.mesh(labels, **options)
        self.assertAlmostEqual(plan["cells"] / len(mesh.cells), 1, delta=0.2)
        core = plan["labels"][1]
        self.assertEqual((core["value"], core["name"], core["components_mm3"]), (2, "core", [108, 0.5]))
        whole = [part for part in plan["thin_parts"] if part["kind"] == "whole"]
        self.assertEqual([part["place_mm"] for part in whole], [[0.5, 1, 1]])
        fewer = podm.plan(labels, drop_islands=1, **options)
        self.assertEqual(fewer["labels"][1]["components_mm3"], [108])
        mesh = podm.mesh(labels, drop_islands=1, **options)
        self.assertEqual(mesh.record["dropped_islands"][0]["volume_mm3"], 0.5)
        self.assertTrue(mesh.verify())

    def test_a_label_that_is_dropped_whole_is_warned_of(self):
        labels = np.zeros((20, 20, 20), np.uint8)
        labels[4:16, 4:16, 4:16] = 1
        labels[0, 0, 0] = 3
        with self.assertWarnsRegex(UserWarning, "label 3 is dropped entirely, 1 mm"):
            podm.plan(labels, drop_islands=5)

    def test_bad_arguments_are_refused(self):
        labels = np.ones((8, 8, 8), np.uint8)
        for options in {"radius": -1}, {"delta": float("nan")}, {"drop_islands": -2}, {"radius_of": {9: 1}}:
            with self.assertRaises(podm.Error), warnings.catch_warnings():
                podm.plan(labels, **options)


if __name__ == "__main__":
    unittest.main()
