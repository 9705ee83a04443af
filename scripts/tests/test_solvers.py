"""Tests the cost of meshes for a solver, and their dihedral angles, from synthetic rows."""
import unittest

import paths  # noqa: F401
import pandas
import synthetic
from figures import dihedral, solvers
from figures.load import derived


def frame_of(rows):
    return pandas.json_normalize([{**row, **derived(row)} for row in rows], sep=".")


ROWS = [synthetic.solved(200), synthetic.solved(180, min_dihedral=8.0, angles=(7.5, 160)),
        synthetic.solved(140, min_dihedral=8.0, optimize=True, angles=(12, 160)),
        synthetic.solved(160, mesher="tetgen"), synthetic.solved(300, image="other")]


class Solvers(unittest.TestCase):
    def test_each_mesh_has_a_line_with_its_iterations(self):
        table = solvers.solvers(frame_of(ROWS)).set_index(["image", "variant"])
        found = table["poisson_jacobi"].to_dict()
        self.assertEqual(found, {("synthetic", solvers.NONE): 200, ("synthetic", solvers.MOVED): 180,
                                 ("synthetic", solvers.BOTH): 140, ("synthetic", "TetGen"): 160,
                                 ("other", solvers.NONE): 300})
        self.assertEqual(table.loc[("synthetic", solvers.NONE), "poisson_amg"], 20)

    def test_angles_beyond_the_bounds_are_counted_per_million_cells(self):
        table = solvers.solvers(frame_of(ROWS)).set_index(["image", "variant"])
        columns = ["small_per_million", "large_per_million"]
        self.assertEqual(list(table.loc[("synthetic", solvers.NONE), columns]), [3e6, 3e6])
        self.assertEqual(list(table.loc[("synthetic", solvers.MOVED), columns]), [3e6, 0])
        self.assertEqual(list(table.loc[("synthetic", solvers.BOTH), columns]), [0, 0])

    def test_rows_that_failed_or_were_not_solved_are_left_out(self):
        rows = [synthetic.row(), synthetic.solved(200, status="unmet"), synthetic.solved(200, warmup=True)]
        self.assertTrue(solvers.solvers(frame_of(rows)).empty)
        self.assertIsNone(solvers.figure(frame_of(rows)))
        self.assertIsNone(solvers.figure(frame_of([synthetic.row()])))

    def test_other_meshers_count_and_their_misses_are_reported(self):
        rows = [synthetic.solved(160, mesher="tetgen", status="unmet"), synthetic.solved(200)]
        table = solvers.solvers(frame_of(rows))
        self.assertEqual(dict(zip(table["variant"], table["misses"])), {solvers.NONE: "", "TetGen": "delaunay"})

    def test_of_several_sizes_the_largest_is_shown(self):
        small = synthetic.solved(90, cells=100_000)
        small["trial"] = "0.1M-none"
        table = solvers.solvers(frame_of([*ROWS[:3], small]))
        self.assertEqual(list(table["poisson_jacobi"]), [200, 180, 140])

    def test_bars_are_iterations_by_image_and_preconditioner(self):
        figure = solvers.figure(frame_of(ROWS))
        titles = [axes.get_title() for axes in figure.axes]
        self.assertEqual(titles, ["other: Jacobi", "synthetic: Jacobi", "other: algebraic multigrid",
                                  "synthetic: algebraic multigrid"])
        heights = {bar.get_height() for bar in figure.axes[1].patches}
        self.assertEqual(heights, {200, 180, 140, 160})


class Dihedral(unittest.TestCase):
    def test_an_image_shows_the_angles_before_and_after(self):
        figure = dihedral.figure(frame_of(ROWS))
        (axes,) = figure.axes  # the other image has no second variant
        words = [text.get_text() for text in axes.get_legend().get_texts()]
        self.assertEqual(words, ["no option: 5.00 to 170.00", "R7: 7.50 to 160.00", "both stages: 12.00 to 160.00"])
        self.assertEqual(axes.get_yscale(), "log")
        for variant, steps in zip((5, 7, 12), axes.patches):
            self.assertEqual(steps.get_data().values[variant], 3e6)

    def test_nothing_is_drawn_of_one_kind_of_mesh(self):
        self.assertIsNone(dihedral.figure(frame_of(ROWS[:1])))
        self.assertIsNone(dihedral.figure(frame_of([synthetic.row()])))


if __name__ == "__main__":
    unittest.main()
