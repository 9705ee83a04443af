"""Tests the tables of lines, flat boxes and thin layers, from synthetic rows."""
import unittest

import paths  # noqa: F401
from figures import shapes
from figures.load import RecordError


def row(asked, image="crystal", **values):
    return {"trial": f"some,input={image}", "asked": asked, "input": {"name": image, "sha256": image}, "repeat": 1,
            "warmup": False, "status": "ok", "reason": "", "replay": "equal", "cells": 100, **values}


WAYS = {"image_to_mesh": {"share_near": 0.99, "furthest_mm": 3}, "mesh_to_image": {"share_near": 0.5, "furthest_mm": 4}}
LINES = {"traced_mm": 800.4, "kept_mm": 799.6, "share_kept": 0.999, "stray_mm": 2, "undecided": [{}],
         "is_claimed": True}


class Shapes(unittest.TestCase):
    def line(self, table):
        self.assertEqual(len(table), 1)
        return {title: str(value) for title, value in table.iloc[0].items()}

    def test_lines_are_beside_the_same_run_without_them(self):
        rows = [row({"lines": False, "radius_mm": 6}, cells=80), row({"lines": False, "radius_mm": 3}, cells=50),
                row({"lines": False, "radius_mm": 6}, image="other", cells=1),
                row({"lines": True, "radius_mm": 6}, lines=LINES, line_distances=WAYS),
                row({"lines": True, "mesher": "cgal6"})]
        line = self.line(shapes.lines(rows))
        self.assertEqual((line["kept, %"], line["cells over without"], line["lines promised"]),
                         ("99.900", "1.250", "yes"))
        self.assertEqual((line["image near mesh, %"], line["mesh near image, %"]), ("99.000", "50.000"))

    def test_a_failed_run_has_its_reason(self):
        rows = [row({"lines": True}, status="failed", reason="killed", lines=None, replay=None)]
        self.assertEqual(self.line(shapes.lines(rows))["claims"], "failed: killed")

    def test_peers_have_medians_and_missing_lines(self):
        rows = [row({"lines": True, "mesher": "cgal6"}, repeat=repeat, line_distances=WAYS, interface_distance_mm=2.5,
                    phases_s={"read": 50, "prepare": 1, "refine": seconds})
                for repeat, seconds in ((1, 9), (2, 4), (3, 5))]
        line = self.line(shapes.peers(rows))
        self.assertEqual((line["lines missing, %"], line["seconds"]), ("1.000", "6.00"))

    def test_boxes_and_thin_layers(self):
        flat = row({"box": "flat"}, facets_of_sides={"i-": 3, "k+": 4}, box_ulps_off=0.0, guarantees={"off_sides": 2})
        self.assertEqual(self.line(shapes.boxes([row({"box": "open"}), flat]))["facets on sides"], "7")
        kept = row({"thin": "keep"}, verdicts={"topology": "pass"},
                   thin_layers={"components": 3, "ambiguous_places": 9, "differences_at_first": 5, "passes": 2,
                                "differences": [{"kind": "lost"}]})
        line = self.line(shapes.thin([row({"thin": "lose"}), kept]))
        self.assertEqual((line["left and listed"], line["topology"]), ("1", "pass"))

    def test_angles_pair_runs_without_and_with(self):
        rows = [{"size": 64, "smooth_voxels": 1.5, "delta_voxels": 1, "cells": 9, "at_lines": {"mean_deg": mean},
                 "away": {"mean_deg": 2}, "ratio_of_means": 0.2} for mean in (20, 4)]
        line = self.line(shapes.angles(rows))
        self.assertEqual((line["at lines, without, degrees"], line["at lines, with, degrees"]), ("20.00", "4.00"))

    def test_no_such_rows_is_a_fault(self):
        with self.assertRaises(RecordError):
            shapes.boxes([row({"lines": True})])


if __name__ == "__main__":
    unittest.main()
