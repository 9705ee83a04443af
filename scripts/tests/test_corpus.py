"""Tests the table, the rates and the section of a corpus of images, from synthetic rows."""
import unittest

import paths  # noqa: F401
import pandas
import synthetic
from figures import corpus, outcome
from figures.load import Records, derived
from report_page.page import page


def image_row(image, setting="default", **changes):
    made = synthetic.peer("cgal") if setting == "cgal" else synthetic.row()
    made.update(experiment="corpus", trial=f"{setting},input={image}", stderr_tail="",
                input={"name": f"/images/{image}", "path": f"/images/{image}", "size": [100, 100, 50]},
                process={"wall_s": 8.0, "peak_rss_bytes": 3 * 2**20, "exit_code": 0}, **changes)
    return made


def without_mesh(image, setting="default", exit_code=2, said="podm: /images/{}: one value per voxel is needed",
                 **changes):
    made = image_row(image, setting, status="failed", reason="exit code 2")
    for key in ("cells", "verdicts", "phases_s", "threads", "quality", "algorithm"):
        del made[key]
    made.update(stderr_tail=said.format(image) + "\n", **changes)
    made["process"]["exit_code"] = exit_code
    made["input"]["size"] = None
    return made


def frame_of(*rows):
    return pandas.json_normalize([{**row, **derived(row)} for row in rows], sep=".")


class Corpus(unittest.TestCase):
    def line(self, *rows):
        (line,) = corpus.corpus(frame_of(*rows)).to_dict("records")
        return line

    def test_a_mesh_with_all_promised_claims_is_a_success(self):
        line = self.line(image_row("a.nii"))
        self.assertEqual((line["outcome"], line["proved"], line["promised"]), (corpus.SUCCESS, 6, 6))
        self.assertEqual((line["seconds"], line["memory_mib"], line["voxels"]), (8.0, 3.0, 500_000))

    def test_a_file_that_is_refused_is_no_success_and_has_its_reason(self):
        line = self.line(without_mesh("b.nrrd"))
        self.assertEqual((line["outcome"], line["why"]), (corpus.REFUSED, "one value per voxel is needed"))

    def test_a_crash_a_missed_claim_and_a_time_limit_are_failures(self):
        unmet = image_row("a.nii", status="unmet", reason="surface fail",
                          verdicts={**synthetic.PASSED, "surface": "fail"})
        for row, why in ((unmet, "unmet: surface fail"), (without_mesh("a.nii", exit_code=None), "failed: exit code 2"),
                         (without_mesh("a.nii", said=""), "failed: exit code 2"),
                         (without_mesh("a.nii", exit_code=None, status="timed_out", reason="time limit"),
                          "timed_out: time limit")):
            line = self.line(row)
            self.assertEqual((line["outcome"], line["why"]), (corpus.FAILED, why))
        self.assertEqual(self.line(unmet)["proved"], 6)

    def test_claims_that_another_mesher_does_not_promise_do_not_count(self):
        line = self.line(image_row("a.nii", "cgal"))
        self.assertEqual((line["outcome"], line["proved"], line["promised"]), (corpus.SUCCESS, 1, 1))

    def test_the_newest_row_of_an_image_and_setting_counts(self):
        self.assertEqual(self.line(without_mesh("a.nii", build=1), image_row("a.nii"))["outcome"], corpus.SUCCESS)

    def test_images_of_one_name_in_two_folders_are_two(self):
        other = without_mesh("a.nii")
        other["input"]["path"] = "/others/a.nii"
        table = corpus.corpus(frame_of(other, image_row("a.nii")))
        self.assertEqual(dict(zip(table["image"], table["outcome"])),
                         {"/images/a.nii": corpus.SUCCESS, "/others/a.nii": corpus.REFUSED})

    def test_other_experiments_and_warm_ups_are_left_out(self):
        self.assertTrue(corpus.corpus(frame_of(synthetic.row(), image_row("a.nii", warmup=True))).empty)
        self.assertTrue(corpus.corpus(pandas.DataFrame()).empty)

    def test_the_rate_is_that_of_all_files(self):
        table = corpus.corpus(frame_of(*(image_row(f"{name}.nii") for name in "abc"), without_mesh("d.nii"),
                                       image_row("a.nii", "slivers", optimization={"beyond_bounds": 7})))
        rates = corpus.rates(table).set_index("setting")
        self.assertEqual(list(rates.loc["default", ["images", "success", "refused", "failed", "rate"]]),
                         [4, 3, 1, 0, 0.75])
        self.assertEqual(list(rates.loc["slivers", ["without a row", "cells beyond bounds"]]), [3, 7])
        self.assertIn("default: 3 of 4 images (1 refused)", corpus.summary(table))

    def test_the_worst_are_those_without_success_and_then_the_slowest_per_voxel(self):
        rows = [image_row(f"{number:02}.nii") for number in range(12)]
        for number, row in enumerate(rows):
            row["process"]["wall_s"] = 1.0 + number
        worst = corpus.worst(corpus.corpus(frame_of(*rows, without_mesh("z.nii"))))
        self.assertEqual(list(worst["image"])[:3], ["z.nii", "11.nii", "10.nii"])
        self.assertEqual(len(worst), corpus.MOST_WORST)

    def test_images_without_a_row_of_cgal_are_named_with_the_reason(self):
        table = corpus.corpus(frame_of(image_row("a.nii"), image_row("b.nii"), image_row("a.nii", "cgal")))
        self.assertIn("for 1 of 2 images (b.nii)", corpus.why_without_rows(table))
        self.assertEqual(corpus.why_without_rows(table[table["image"] == "a.nii"]), "")

    def test_the_page_has_the_section_and_escapes_what_programs_said(self):
        frame = frame_of(image_row("a.nii"), without_mesh("b.nii", said="podm: /images/{}: <b>odd</b>"))
        made = page(Records(frame, []), outcome.make(frame))
        self.assertIn("default: 1 of 2 images (1 refused).", made)
        self.assertIn("&lt;b&gt;odd&lt;/b&gt;", made)
        self.assertNotIn("<b>odd", made)
        self.assertIn("make corpus FOLDER=FOLDER", page(Records(frame_of(synthetic.row()), []),
                                                        outcome.make(frame_of(synthetic.row()))))


if __name__ == "__main__":
    unittest.main()
