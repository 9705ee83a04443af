"""Tables, figures and verdicts from made-up rows."""
import math
import unittest

import paths  # noqa: F401
import pandas
import synthetic
from figures import cache, fig1, fig4a, fig4b, outcome, paper, scaling, spread, table1, table2, table3, verdicts
from figures.load import derived
from figures.write import markdown, svg_of


def frame_of(rows):
    return pandas.json_normalize([{**row, **derived(row)} for row in rows], sep=".")


def with_hops(rows, shares):
    for row in rows:
        if row["algorithm"] == "pdr-podm":
            row["hops"] = [int(1e6 * share) for share in shares]
        yield row


class Spread(unittest.TestCase):
    def test_interval_holds_the_median_and_shrinks_with_the_spread(self):
        for width in (1, 10):
            middle, low, high = spread.median_interval([100 + width * step for step in (-2, -1, 0, 1, 2)])
            self.assertEqual(middle, 100)
            self.assertTrue(100 - 2 * width <= low <= 100 <= high <= 100 + 2 * width)
        self.assertEqual(spread.median_interval([5, 5, 5]), (5, 5, 5))

    def test_one_value_has_no_interval(self):
        self.assertTrue(math.isnan(spread.median_interval([3.0])[1]))
        self.assertTrue(math.isnan(spread.ratio_interval([3.0], [1.5])[2]))


class Scaling(unittest.TestCase):
    def test_speedup_is_equation_1(self):
        frame = frame_of(synthetic.like_the_paper(paper.table1(), repeats=3, spread=0))
        (series,) = scaling.weak_series(frame)
        published = paper.corrected_table1()
        self.assertEqual(set(series.table.index), set(published.index))
        for index, row in series.table.iterrows():
            self.assertAlmostEqual(row["speedup"] / published.loc[index, "speedup"], 1, delta=0.025)
            self.assertAlmostEqual(row["efficiency"], row["speedup"] / index[1])
            self.assertAlmostEqual(sum(row[phase] for phase in scaling.PHASES), row["seconds"])

    def test_rows_that_did_not_verify_count_nowhere(self):
        rows = [synthetic.row(), synthetic.row(), synthetic.row(cores=2),
                synthetic.row(cores=2, cells=6_000_001, verdicts={**synthetic.PASSED, "delaunay": "fail"})]
        (series,) = scaling.weak_series(frame_of(rows))
        self.assertEqual(series.table.loc[("podm", 2), "n"], 1)

    def test_measured_and_simulated_are_never_one_series(self):
        rows = [synthetic.row(), synthetic.row(executor="virtual"), synthetic.row(cores=64, executor="virtual")]
        series = scaling.weak_series(frame_of(rows))
        self.assertEqual({one.key["basis"]: len(one.table) for one in series}, {"measured": 1, "simulated": 2})
        self.assertEqual(set(table1.table1(series)["basis"]), {"published", "measured", "simulated"})

    def test_machines_programs_and_inputs_are_kept_apart(self):
        other = synthetic.row()["environment"] | {"cpu": "Another"}
        rows = [synthetic.row(), synthetic.row(cores=2), synthetic.row(cores=2, environment=other),
                synthetic.row(cores=2, input={"path": "other.nii"}), synthetic.row(cores=2, programs={})]
        (series,) = scaling.weak_series(frame_of(rows))
        self.assertEqual(series.table.loc[("podm", 2), "n"], 1)

    def test_rows_whose_cells_do_not_grow_with_the_cores_are_left_out(self):
        (series,) = scaling.weak_series(frame_of([synthetic.row(), synthetic.row(cores=2, cells=3_000_000)]))
        self.assertNotIn(("podm", 2), series.table.index)

    def test_the_series_nearest_to_the_paper_comes_first(self):
        rows = [synthetic.row(cells=cells) for cells in (300_000, 3_000_000, 1_000_000)]
        self.assertEqual([series.cells_per_core for series in scaling.weak_series(frame_of(rows))], [3e6, 1e6, 3e5])

    def test_phases_of_other_names_and_peers_are_kept(self):
        rows = [synthetic.row(phases_s={"refine": 20.0, "close": 5.0, "write": 1.0}), synthetic.row("some-peer")]
        series = scaling.weak_series(frame_of(rows))
        self.assertEqual(series[0].table.loc[("podm", 1), "other"], 5.0)
        self.assertIn("some-peer", set(table1.table1(series)["algorithm"]))
        for draw in (fig4a.fig4a, fig4b.fig4b):
            self.assertIn("n\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}1", draw(series).get_label())

    def test_no_series_without_one_core_of_podm(self):
        self.assertEqual(scaling.weak_series(frame_of([synthetic.row(cores=2), synthetic.row("pdr-podm")])), [])
        self.assertEqual(scaling.weak_series(frame_of([])), [])


class Hops(unittest.TestCase):
    def test_counts_are_added_up_into_shares(self):
        rows = [synthetic.row("pdr-podm", 32, environment=synthetic.BIG_MACHINE, hops=hops)
                for hops in ([90, 10], [100, 0, 0])]
        ours = table2.table2(frame_of(rows)).query("basis == 'measured'").set_index("hops")["share"]
        self.assertEqual([ours[0], ours[1], ours[2]], [0.95, 0.05, 0])

    def test_unavailable_is_a_reason_and_never_zero(self):
        frame = frame_of([synthetic.row("pdr-podm", 2, hops="unavailable: one node")])
        self.assertEqual(set(table2.table2(frame)["basis"]), {"published"})
        self.assertEqual(table2.why_no_hops(frame), "unavailable: one node")


class Levels(unittest.TestCase):
    def test_ours_stand_beside_the_published(self):
        def row(cycles, dram=300.0):
            return synthetic.row(memory_levels=[
                {"level": 1, "module": "L1 cache", "size_bytes": 49152, "cycles": cycles},
                {"level": 2, "module": "memory of the own node 0", "size_bytes": 2**33, "cycles": dram}])

        ours = table3.table3(frame_of([row(4.0), row(9.0), row(4.2)])).query("basis == 'measured'")
        self.assertEqual(list(ours["size"]), ["48 KiB", "8 GiB"])
        self.assertEqual(list(ours["access_clock_cycles"]), ["4.2", "300"])
        why = "unavailable: not enough memory"
        ours = table3.table3(frame_of([row(4.0, why)])).query("basis == 'measured'")
        self.assertEqual(list(ours["access_clock_cycles"]), ["4", why])
        self.assertEqual(set(table3.table3(frame_of([synthetic.row()]))["basis"]), {"published"})


class Cache(unittest.TestCase):
    SIMULATED = "valgrind cachegrind (simulated: some caches)"

    def counted(self, insertions, misses, source, **changes):
        return synthetic.row(counters={"insertions": {"R1": insertions - 100, "R2": 100}},
                             used={"radius_mm": 1e4 / insertions},
                             process={"counters": {"llc_load_misses": {"value": misses, "source": source},
                                                   "page_faults": {"value": 7, "source": "perf_event"}}}, **changes)

    def test_only_what_a_further_insertion_costs_counts(self):
        # 1000 misses of the image, 20 an insertion.
        table = cache.cache(frame_of([self.counted(number, 1000 + 20 * number, "perf_event") for number in (500, 200, 900)]))
        self.assertEqual(list(table["per_insertion"]), [20, 20])
        self.assertEqual(set(table["counter"]), {"llc_load_misses"}, "page faults are no matter of caches")

    def test_simulated_and_measured_are_apart_and_simulated_gives_no_headline(self):
        rows = [self.counted(number, cost * number, source) for number in (100, 300)
                for cost, source in ((2, "perf_event"), (5, self.SIMULATED))]
        frame = frame_of(rows)
        costs = cache.cache(frame).set_index("basis")["per_insertion"]
        self.assertEqual(dict(costs), {"measured": 2, "simulated": 5})
        self.assertEqual(set(scaling.headline_rows(frame)["basis"]), {"measured"})

    def test_what_was_not_counted_is_a_reason(self):
        why = "unavailable: no such counter"
        table = cache.cache(frame_of([synthetic.row(process={"counters": {"cycles": why}})]))
        self.assertEqual(list(table["reason"]), [why])
        self.assertIn(why, list(cache.readable(table)["per further insertion"]))
        self.assertTrue(cache.cache(frame_of([synthetic.row()])).empty)

    def test_meshes_that_failed_count_for_nothing(self):
        rows = [self.counted(number, number, self.SIMULATED, status="unmet") for number in (100, 300)]
        self.assertTrue(cache.cache(frame_of(rows)).empty)


class Verdicts(unittest.TestCase):
    def verdicts(self, rows):
        frame = frame_of(rows)
        return verdicts.verdicts(frame, scaling.weak_series(frame), table2.table2(frame))

    def cell(self, found, **where):
        (cell,) = [one for one in found["cells"] if all(one[key] == value for key, value in where.items())]
        return cell

    def test_the_paper_agrees_with_itself(self):
        rows = with_hops(synthetic.like_the_paper(paper.table1()), [0.99, 0.004, 0.003, 0.003])
        found = self.verdicts(rows)
        measured = [one for one in found["cells"] if one["basis"] == "measured" and one["cores"] != 16]
        self.assertEqual({one["verdict"] for one in measured}, {"agrees", "reference"})
        self.assertEqual({one["verdict"] for one in found["claims"] if one["basis"] == "measured"}, {"agrees"})

    def test_every_cell_has_a_value_or_a_reason(self):
        for rows in ([], [synthetic.row()], [synthetic.row("pdr-podm")]):
            found = self.verdicts(rows)
            self.assertEqual(len(found["cells"]), 2 * (2 * 8 * 5 + 8 * 5))
            for cell in found["cells"]:
                self.assertTrue(cell["reason"] if cell["value"] is None else cell["n"], cell)

    def test_a_small_machine_is_the_reason(self):
        found = self.verdicts([synthetic.row(), synthetic.row(cores=2)])
        cell = self.cell(found, table="1", basis="measured", algorithm="podm", cores=32, column="speedup")
        self.assertEqual((cell["verdict"], cell["reason"]), ("cannot_fill", "needs 32 cores, has 2"))
        cell = self.cell(found, table="1", basis="measured", algorithm="pdr-podm", cores=1, column="rate")
        self.assertEqual(cell["reason"], "no measured row of pdr-podm with 1 cores")

    def test_rows_that_failed_are_the_reason(self):
        failed = synthetic.row("pdr-podm", verdicts={**synthetic.PASSED, "size": "fail"})
        cell = self.cell(self.verdicts([synthetic.row(), failed]), table="1", basis="measured", algorithm="pdr-podm",
                         cores=1, column="rate")
        self.assertEqual(cell["reason"], "no row to count: claim size failed")

    def test_better_and_worse_than_the_paper(self):
        def speedup(factor):
            rows = list(synthetic.like_the_paper(paper.table1(), executor="virtual"))
            for row in rows:
                if row["threads"]["used"] == 256:
                    row["phases_s"] = {phase: seconds / factor for phase, seconds in row["phases_s"].items()}
            return self.cell(self.verdicts(rows), table="1", basis="simulated", algorithm="podm", cores=256, column="speedup")

        self.assertEqual(speedup(2)["verdict"], "better")
        self.assertEqual(speedup(0.5)["verdict"], "differs")

    def test_crossover(self):
        self.assertEqual(verdicts.crossover(paper.table1()), 160)
        self.assertIsNone(verdicts.crossover(paper.table1().query("cores <= 128")))


class Drawing(unittest.TestCase):
    def test_every_line_is_published_measured_or_simulated(self):
        rows = [synthetic.row(), synthetic.row(cores=2), *synthetic.like_the_paper(paper.table1(), executor="virtual")]
        series = scaling.weak_series(frame_of(rows))
        for draw in (fig4a.fig4a, fig4b.fig4b):
            figure = draw(series)
            words = {text.get_text() for axes in figure.axes if axes.get_legend() for text in axes.get_legend().get_texts()}
            self.assertTrue({"PODM, paper", "PODM, measured", "PODM, simulated", "PDR.PODM, simulated"} <= words, words)
            self.assertNotIn("PDR.PODM, measured", words)
            self.assertIn("bootstrap 95 %", figure.get_label())

    def test_figures_without_rows_show_the_paper(self):
        made = outcome.make(frame_of([]))
        self.assertEqual(set(made.figures), {"fig4a", "fig4b"})
        self.assertIn("no verified", made.figures["fig4a"].get_label())
        self.assertEqual(set(made.missing), {"fig1", "fig2b"})

    def test_quality(self):
        self.assertEqual(len(fig1.fig1(synthetic.report()).axes), 3)
        self.assertEqual(len(fig1.fig1_extremes(frame_of([synthetic.row()])).axes), 2)
        self.assertIsNone(fig1.fig1_extremes(frame_of([synthetic.row(status="failed")])))

    def test_svg_of_two_figures_share_no_id(self):
        import re

        found = [set(re.findall(r'\bid="([^"]+)"', svg_of(fig4a.fig4a([]), name))) for name in ("one", "two")]
        self.assertTrue(found[0] and not found[0] & found[1])

    def test_markdown_escapes_bars_and_leaves_gaps_empty(self):
        table = pandas.DataFrame({"a": ["x|y", None], "b": [0.12346, float("nan")]})
        self.assertEqual(markdown(table).splitlines()[2:], ["| x\\|y | 0.1235 |", "|  |  |"])


if __name__ == "__main__":
    unittest.main()
