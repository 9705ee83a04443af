"""The page of one mesh: how it judges bounds on dihedral angles, and that its boxes hold what is in them."""
import copy
import sys
import tempfile
import unittest
from pathlib import Path

import paths  # noqa: F401  (makes report_page importable)
import synthetic
from browser import Browser, find_chromium
from report_page import dihedral_bounds
from report_page.mesh_page import page

QUALITY = {"max_radius_edge": 1.929174, "min_facet_angle_deg": 30.016466, "max_facet_angle_deg": 118.2,
           "min_dihedral_deg": 8.00104, "max_dihedral_deg": 164.998617, "max_radius_mm": 11.7018,
           "shortest_edge_mm": 5.7}
RECORD = {
    "cells": 162, "vertices": 64, "boundary_facets": 108, "program": "podm 0.1.0", "algorithm": "podm",
    "input": {"path": "a.nii.gz", "sha256": "0" * 64}, "threads": {"used": 1}, "cells_per_second": 1e5,
    "peak_rss_bytes": 1e8, "used": {"radius_mm": 12, "delta_mm": 6}, "stop_reason": "complete", "mesh_sha256": "1" * 64,
    "options": {"space": "RAS", "optimize": None, "min_dihedral_deg": 0}, "phases_s": {"refine": 0.5}, "warnings": [],
    "labels": [{"value": 1, "volume_mm3": 13.5}, {"value": 2, "volume_mm3": 13.5}], "quality": QUALITY,
    "perturbed": None, "optimization": None,
    "guarantees": dict.fromkeys(("radius_edge", "facet_angle", "radius", "facet_vertices", "orientation",
                                 "missing_labels", "topology"), 0)}


def perturbed(low, left=0, **unmoved):
    record = copy.deepcopy(RECORD)
    record["options"]["min_dihedral_deg"] = low
    record["perturbed"] = {
        "min_dihedral_deg": low, "max_dihedral_deg": 175 - 1.25 * low, "before": {"with_free_vertex": 9, "without": 8},
        "after": {"with_free_vertex": left, "without": 0},
        "unmoved": {**dict.fromkeys(("not_reached", "spacing", "shape", "surface"), 0), **unmoved}}
    return record


def optimized(record, left=0, **obstacles):
    record = copy.deepcopy(record)
    record["options"]["optimize"] = {"least_dihedral_deg": 8.0, "largest_dihedral_deg": 165.0}
    record["optimization"] = {"beyond_bounds": left, "beyond_bounds_before": 7, "obstacles": {
        **dict.fromkeys(("frozen_facets", "junction", "frozen_vertices", "other"), 0), **obstacles}}
    return record


class Bounds(unittest.TestCase):
    def judged(self, record):
        return dihedral_bounds.judged(record)

    def test_without_an_option_there_is_no_bound(self):
        self.assertEqual(self.judged(RECORD), [])
        self.assertIsNone(dihedral_bounds.asked(RECORD))

    def test_what_r7_leaves_decides(self):
        (verdict, statement, reason), = self.judged(perturbed(8))
        self.assertEqual((verdict, statement), ("pass", "all cells have dihedral angles from 8 to 165 degrees "
                                                        "(--min-dihedral 8)"))
        self.assertEqual(reason, "cells out of bounds: 0, before 17")
        (verdict, _, reason), = self.judged(perturbed(20, left=5, shape=4, surface=1))
        self.assertEqual((verdict, reason), ("fail", "cells out of bounds: 5, before 17 (no better place found 4, held "
                                                     "by the surface 1)"))

    def test_what_optimisation_leaves_decides(self):
        (verdict, statement, _), = self.judged(optimized(RECORD))
        self.assertEqual(verdict, "pass")
        self.assertIn("--optimize", statement)
        (verdict, _, reason), = self.judged(optimized(RECORD, left=3, junction=3))
        self.assertEqual((verdict, reason), ("fail", "cells out of bounds: 3, before 7 (three labels meet 3)"))

    def test_after_both_stages_the_finished_mesh_decides_the_bound_of_the_first(self):
        verdicts = [verdict for verdict, *_ in self.judged(optimized(perturbed(8, left=2)))]
        self.assertEqual(verdicts, ["pass", "pass"])
        verdicts = [verdict for verdict, *_ in self.judged(optimized(perturbed(20, left=2)))]
        self.assertEqual(verdicts, ["fail", "pass"])
        self.assertEqual(dihedral_bounds.asked(optimized(perturbed(20))), (20, 150))

    def test_a_run_that_ended_before_is_not_judged(self):
        record = optimized(perturbed(8))
        record["perturbed"] = record["optimization"] = None
        self.assertEqual([verdict for verdict, *_ in self.judged(record)], ["not_run", "not_run"])


class Page(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.mesh = self.folder / "mesh.vtu"
        synthetic.write_vtu(self.mesh, *synthetic.box_mesh(3))

    def html(self, record):
        return page({"mesh": str(self.mesh), "name": "mesh.vtu", "record": record, "verification": None, "unmet": []})

    def test_it_says_no_bound_only_where_none_was_asked_for(self):
        self.assertIn("have no bound without", self.html(RECORD))
        for record in (perturbed(8), optimized(RECORD), optimized(perturbed(20, left=2))):
            html = self.html(record)
            self.assertNotIn("have no bound without", html)
            self.assertIn("all cells have dihedral angles from 8 to 165 degrees", html)
            self.assertIn("largest dihedral angle", html)

    def test_nothing_runs_out_of_its_line_or_its_box(self):
        if find_chromium() is None:
            print("skipped: chromium is not installed", file=sys.stderr)
            self.skipTest("not installed")
        path = self.folder / "mesh.html"
        path.write_text(self.html(optimized(perturbed(8))))
        browser = Browser()
        self.addCleanup(browser.close)
        for width, scheme in ((1400, "light"), (1400, "dark"), (1024, "light"), (400, "light"), (400, "dark")):
            with self.subTest(width=width, scheme=scheme):
                browser.open(path, width, scheme=scheme)
                self.assertEqual(browser.errors, [])
                self.assertEqual(browser.evaluate("document.documentElement.scrollWidth"), width)
                self.assertEqual(browser.evaluate("""[...document.querySelectorAll('.bars li, .answer')].flatMap(box =>
                    [...box.querySelectorAll('*')].filter(one => one.checkVisibility() &&
                        one.getBoundingClientRect().right > box.getBoundingClientRect().right + 0.5 ||
                        one.scrollWidth > one.clientWidth + 1 && getComputedStyle(one).display !== 'inline')
                    .map(one => one.outerHTML))"""), [])


if __name__ == "__main__":
    unittest.main()
