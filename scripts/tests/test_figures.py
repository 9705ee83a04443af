"""Tests tables, figures and verdicts from synthetic rows."""
import contextlib
import io
import math
import unittest

import paths  # noqa: F401
import pandas
import synthetic
from figures import (cache, experiment_verdicts, fig1, fig4a, fig4b, guarantees, outcome, paper, peers, scaling,
                     simulated, spread, table1, table2, table3)
from figures.__main__ import print_experiments
from figures.load import derived
from figures.write import markdown, svg_of


def frame_of(rows):
    return pandas.json_normalize([{**row, **derived(row)} for row in rows], sep=".")


class Spread(unittest.TestCase):
    def test_interval_holds_the_median_and_shrinks_with_the_spread(self):
        for width in (1, 10):
            middle, low, high = spread.median_interval([100 + width * step for step in (-2, -1, 0, 1, 2)])
            self.assertEqual(middle, 100)
            self.assertTrue(100 - 2 * width <= low <= 100 <= high <= 100 + 2 * width)
        self.assertEqual(spread.median_interval([5, 5, 5]), (5, 5, 5))

    def test_one_value_has_no_interval(self):
        self.assertTrue(math.isnan(spread.median_interval([3.0])[1]))
        self.assertTrue(all(map(math.isnan, spread.order_interval([3.0]))))


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
        table = table1.table1(series)
        self.assertEqual([len(table[table["basis"] == basis]) for basis in ("measured", "simulated")], [1, 2])
        self.assertFalse(table.duplicated(["basis", "algorithm", "cores"]).any())

    def test_machines_programs_and_inputs_are_kept_apart(self):
        other = synthetic.row()["environment"] | {"cpu": "Another"}
        rows = [synthetic.row(), synthetic.row(cores=2), synthetic.row(cores=2, environment=other),
                synthetic.row(cores=2, input={"name": "other.nii"}), synthetic.row(cores=2, programs={}),
                synthetic.row(cores=2, trial="synthetic,contention=random")]
        (series,) = scaling.weak_series(frame_of(rows))
        self.assertEqual(series.table.loc[("podm", 2), "n"], 1)

    def test_rows_whose_cells_do_not_grow_with_the_cores_are_left_out(self):
        (series,) = scaling.weak_series(frame_of([synthetic.row(), synthetic.row(cores=2, cells=3_000_000)]))
        self.assertNotIn(("podm", 2), series.table.index)

    def test_the_series_nearest_to_the_paper_comes_first(self):
        rows = [synthetic.row(cells=cells) for cells in (300_000, 3_000_000, 1_000_000)]
        self.assertEqual([series.cells_per_core for series in scaling.weak_series(frame_of(rows))], [3e6, 1e6, 3e5])

    def test_refining_alone_is_a_median_of_ratios_within_rounds(self):
        """The machine's speed drifts between rounds; each round has its own speed. The cores share the transform."""
        rows = [synthetic.row(cores=cores, repeat=repeat, cells=3_000_000 * cores,
                              phases_s={"read": 1.0, "transform": 5.0 / cores, "calibrate": 99.0,
                                        "refine": speed * 10.0 / efficiency})
                for repeat, speed in ((1, 1.0), (2, 1.7), (3, 0.6))
                for cores, efficiency in ((1, 1.0), (2, 0.96 if repeat == 1 else 0.98))]
        (series,) = scaling.weak_series(frame_of(rows))
        line = series.table.loc[("podm", 2)]
        self.assertAlmostEqual(line["refining_efficiency"], 0.98)
        self.assertLessEqual(line["refining_efficiency_low"], 0.98)
        self.assertNotAlmostEqual(line["efficiency"], 0.98, places=2)
        caption = fig4a.fig4a([series]).get_label()
        by_equation_1 = f"{100 * line['efficiency']:.0f} % by equation 1"
        self.assertIn(f"PODM on 2 cores has {by_equation_1} and 98 % in refining", caption)

    def test_refining_includes_the_initial_mesh(self):
        phases = {"read": 5.0, "octree": 1.0, "initial": 2.0, "refine": 20.0, "closing": 1.0, "extract": 3.0}
        (series,) = scaling.weak_series(frame_of([synthetic.row(), synthetic.row("pdr-podm", phases_s=phases)]))
        self.assertEqual(series.table.loc[("pdr-podm", 1), "refining_rate"], 3e6 / 24)

    def test_a_round_without_one_core_gives_no_ratio(self):
        rows = [synthetic.row(), synthetic.row(cores=2, repeat=2)]
        (series,) = scaling.weak_series(frame_of(rows))
        self.assertTrue(math.isnan(series.table.loc[("podm", 2), "refining_efficiency"]))
        shown = table1.readable(table1.table1([series]))
        self.assertEqual(list(shown[shown["cores"] == 2]["refining, efficiency %"]), [""])

    def test_an_image_that_grows_is_a_series_of_its_own(self):
        rows = [synthetic.row(cores=cores, trial=f"{name},threads={cores}", input={"name": f"{image}@{side * cores}"})
                for name, image, side in (("0.5M", "phantom:abdomen", 0), ("0.5M-growing", "phantom:abdomen", 128))
                for cores in (1, 2)]
        series = scaling.weak_series(frame_of(rows))
        self.assertEqual({one.grows: len(one.table) for one in series}, {False: 2, True: 2})
        shown = table1.readable(table1.table1(series))
        self.assertEqual(list(shown[shown["cores"] == 2]["images"]), ["one", "growing"])
        self.assertIn("an image that grows with the cores", scaling.first_of(series, "measured", grows=True).label())

    def test_phases_of_other_names_and_peers_are_kept(self):
        rows = [synthetic.row(phases_s={"refine": 20.0, "shut": 5.0, "write": 1.0}), synthetic.row("some-peer")]
        series = scaling.weak_series(frame_of(rows))
        self.assertEqual(series[0].table.loc[("podm", 1), "other"], 5.0)
        self.assertIn("some-peer", set(table1.table1(series)["algorithm"]))
        for draw in (fig4a.fig4a, fig4b.fig4b):
            self.assertIn("n\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}1", draw(series).get_label())

    def test_no_series_without_one_core_of_podm(self):
        self.assertEqual(scaling.weak_series(frame_of([synthetic.row(cores=2), synthetic.row("pdr-podm")])), [])
        self.assertEqual(scaling.weak_series(frame_of([])), [])


class Hops(unittest.TestCase):
    def rows(self, *hops, cores=32, **changes):
        return [synthetic.row("pdr-podm", cores, environment=synthetic.BIG_MACHINE, hops=one, **changes)
                for one in hops]

    def ours(self, rows):
        return table2.table2(frame_of(rows)).query("basis == 'measured'").set_index(["cores", "hops"])

    def test_counts_are_added_up_into_shares(self):
        shares = self.ours(self.rows([90, 10], [100, 0, 0]))["share"]
        self.assertEqual([shares[32, hops] for hops in range(3)], [0.95, 0.05, 0])

    def test_experiments_sizes_and_settings_are_never_added_up(self):
        shown = self.rows([99, 1], cores=32) + self.rows([98, 2], cores=64)
        others = [*self.rows([1, 99], experiment="another"), *self.rows([1, 99], trial="synthetic,initial_ratio=2"),
                  *self.rows([1, 99], input={"name": "another.nii"}), *self.rows([1, 99], cells=5)]
        ours = self.ours([*others, *shown])
        self.assertEqual((ours.loc[(32, 0), "share"], ours.loc[(32, 0), "n"]), (0.99, 1))

    def test_shares_with_the_kinds_that_the_paper_leaves_out(self):
        kinds = {"mesh_reads": [90, 10], "mesh_writes": [10, 10], "image_reads": [0, 20], "transform_reads": [50, 10]}
        ours = self.ours(self.rows([90, 10], hops_by_kind=kinds))
        self.assertEqual((ours.loc[(32, 0), "share"], ours.loc[(32, 0), "share_all_kinds"]), (0.9, 0.75))
        shown = table2.readable(table2.table2(frame_of(self.rows([90, 10], hops_by_kind=kinds))))
        self.assertIn("75.00 %", list(shown["0 hops, all kinds"]))
        ours = self.ours(self.rows([90, 10], hops_by_kind="unavailable: not counted"))
        self.assertTrue(math.isnan(ours.loc[(32, 0), "share_all_kinds"]))

    def test_unavailable_is_a_reason_and_never_zero(self):
        frame = frame_of([synthetic.row("pdr-podm", 2, hops="unavailable: one node")])
        self.assertEqual(set(table2.table2(frame)["basis"]), {"published"})
        self.assertEqual(table2.why_no_hops(frame), "unavailable: one node")


class Simulated(unittest.TestCase):
    def row(self, **changes):
        return synthetic.row("pdr-podm", 64, executor="virtual", hops=[3, 1],
                             phases_s={"initial": 2.0, "refine": 6.0}, **changes)

    def test_seconds_are_virtual_and_the_wall_time_is_in_its_own_column(self):
        shown = simulated.readable(simulated.simulated(frame_of([self.row()])))
        (line,) = shown.to_dict("records")
        self.assertEqual(line["simulated seconds"], "8")
        self.assertEqual(line["M cells per simulated second"], "24")
        self.assertEqual(line["simulated contention, worker seconds"], "3")
        self.assertEqual(line["simulated 0 hops"], "75.00 %")
        self.assertEqual(line["wall time of the simulation, s"], "1.23e+03")
        heads = [head for head in shown if "second" in head or "hops" in head]
        self.assertTrue(all("simulated" in head for head in heads), heads)
        self.assertFalse([head for head in shown if "time" in head and "wall" not in head])

    def test_simulated_numbers_are_marked_and_named_and_no_others(self):
        rows = [synthetic.row(), synthetic.row("pdr-podm", hops=[3, 1]), self.row(), synthetic.row(executor="virtual")]
        for name, number in (("table1", "seconds"), ("table2", "0 hops")):
            shown = outcome.make(frame_of(rows)).tables[name][1]
            is_simulated = shown["basis"].str.startswith("simulated, 3\N{NO-BREAK SPACE}M cells per core")
            self.assertTrue(is_simulated.any() and not is_simulated.all(), shown)
            is_marked = shown[number].str.startswith(table1.MARKS["simulated"])
            self.assertEqual(list(is_marked), list(is_simulated))
        made = outcome.make(frame_of(rows[:2])).tables
        self.assertFalse([name for name in made if name in ("simulated", "machine", "deviation", "lost", "validation")])

    def test_what_was_not_counted_is_a_reason(self):
        why = "unavailable: one NUMA node"
        self.assertEqual(list(simulated.simulated(frame_of([{**self.row(), "hops": why}]))["zero_hops"]), [why])

    def test_phases_of_figure_4b_are_virtual(self):
        series = scaling.weak_series(frame_of([synthetic.row(executor="virtual"), self.row()]))
        line = series[0].table.loc[("pdr-podm", 64)]
        self.assertEqual((line["initial"], line["refine"], line["read"]), (2, 6, 0))
        self.assertIn("virtual seconds of the phases", fig4b.fig4b(series).get_label())


class Others(unittest.TestCase):
    ROWS = [synthetic.row(), synthetic.row(repeat=2), synthetic.peer("tetgen"), synthetic.peer("cgal", status="failed"),
            synthetic.row(warmup=True)]

    def test_their_faults_are_not_ours(self):
        ours = guarantees.ours(frame_of(self.ROWS)).set_index("claim")
        self.assertEqual((ours.loc["delaunay", "pass"], ours.loc["delaunay", "fail"]), (3, 0))
        theirs = guarantees.of_others(frame_of(self.ROWS)).set_index(["mesher", "claim"])
        self.assertEqual(theirs.loc[("tetgen", "delaunay"), "fail"], 1)
        self.assertEqual(theirs.loc[("tetgen", "structure"), "pass"], 1)
        shown = guarantees.readable(guarantees.of_others(frame_of(self.ROWS))).set_index("claim")
        self.assertEqual(shown.loc["delaunay", "tetgen"], "holds for 0 of 1")
        self.assertEqual(shown.loc["structure", "tetgen"], "holds for 1 of 1, promised")

    def test_one_failure_of_ours_is_a_failure(self):
        rows = [*self.ROWS, synthetic.row(verdicts={**synthetic.PASSED, "delaunay": "fail"})]
        shown = guarantees.readable(guarantees.ours(frame_of(rows))).set_index("claim")
        self.assertEqual((shown.loc["delaunay", "verdict"], shown.loc["size", "verdict"]), ("fail", "pass"))

    def test_rates_beside_each_other(self):
        table = peers.peers(frame_of(self.ROWS)).set_index("mesher")
        self.assertEqual(set(table.index), {"podm", "tetgen"}, "a failed run gives no rate")
        self.assertEqual((table.loc["podm", "n"], table.loc["podm", "refining_rate"]), (2, 3e6 / 24))
        self.assertEqual((table.loc["tetgen", "refining_rate"], table.loc["tetgen", "misses"]), (1e5, "delaunay"))
        self.assertAlmostEqual(table.loc["podm", "whole_rate"], 3e6 / 26.18, msg="all but reading and writing")
        self.assertEqual(table.loc["tetgen", "whole_rate"], 1e6 / 14, "the making of its surface counts")
        self.assertAlmostEqual(table.loc["tetgen", "whole_ratio"], 3e6 / 26.18 / (1e6 / 14))
        self.assertTrue(math.isnan(table.loc["podm", "whole_ratio"]))
        self.assertEqual((table.loc["tetgen", "promised"], table.loc["tetgen", "kept"]), (1, 1))
        self.assertEqual((table.loc["podm", "promised"], table.loc["podm", "kept"]), (6, 6))

    def test_ratios_are_within_rounds(self):
        slow = [1.0, 3.0, 1.0, 1.0, 10.0, 1.0]  # slowdown of the machine in each round
        ours = [synthetic.row(repeat=number, phases_s={"read": 9.0, "refine": 2.0 * factor})
                for number, factor in enumerate(slow)]
        theirs = [synthetic.peer("cgal", repeat=number, cells=3_000_000,
                                 phases_s={"prepare": factor, "refine": 7.0 * factor})
                  for number, factor in enumerate(slow)]
        line = peers.peers(frame_of([*ours, *theirs])).set_index("mesher").loc["cgal"]
        self.assertEqual([line["whole_ratio" + end] for end in ("", "_low", "_high")], [4.0, 4.0, 4.0])
        self.assertEqual(line["coverage"], 1 - 2 / 2**6)

    def test_from_the_surface_volume_parts_are_compared(self):
        parts = synthetic.peer("podm_volume", cells=3_000_000, surface_cells=1_000_000,
                               phases_s={"surface": 20.0, "refine": 5.0})
        table = peers.peers(frame_of([synthetic.row(), synthetic.peer("tetgen"), parts])).set_index("mesher")
        self.assertEqual(table.loc["tetgen", "volume_rate"], 1e6 / 10)
        self.assertEqual(table.loc["podm_volume", "volume_rate"], 2e6 / 5, "cells of the surface alone do not count")
        self.assertEqual(table.loc["tetgen", "volume_ratio"], 4)
        self.assertTrue(math.isnan(table.loc["podm", "volume_rate"]), "podm makes both in one")

    def test_meshers_with_bounds_of_their_own_are_one_setting(self):
        made = frame_of([synthetic.row(trial="size-0.3M-one"),
                         synthetic.peer("cgal", trial="size-0.3M-one-bounds-of-cgal,mesher=cgal")])
        self.assertEqual(set(made["setting"]), {"size-0.3M-one"})
        self.assertEqual(list(peers.peers(made)["mesher"]), ["podm", "cgal"])

    def test_cells_facets_bounds_and_version_stand_beside_the_speed(self):
        rows = [synthetic.row(boundary_facets=300), synthetic.peer("tetgen", boundary_facets=310)]
        rows[1]["programs"]["peer"]["version"] = "TetGen 1.5, AGPL-3.0-or-later, surface by podm"
        shown = peers.speed_table(frame_of(rows)).set_index("mesher").loc["tetgen"]
        self.assertEqual((shown["version"], shown["M cells"], shown["facets"]), ("TetGen 1.5", "1.00", "310"))
        self.assertEqual(shown["bounds met"], "1 of 1 promised; misses delaunay")
        rows[1]["promises"] = ["structure", "delaunay", "fidelity"]
        shown = peers.speed_table(frame_of(rows)).set_index("mesher").loc["tetgen"]
        self.assertEqual(shown["bounds met"], "1 of 3 promised, 1 not run; misses delaunay")

    def test_order_statistics_say_their_coverage(self):
        self.assertEqual(spread.order_interval([3, 1, 2]), (1, 3, 0.75))
        self.assertEqual(spread.order_interval(range(6)), (0, 5, 1 - 2 / 64))
        low, high, coverage = spread.order_interval(range(9))
        self.assertEqual((low, high), (1, 7), "nine values spare one at each end")
        self.assertAlmostEqual(coverage, 1 - 2 * 10 / 512)
        self.assertTrue(all(math.isnan(value) for value in spread.order_interval([1])))

    def test_no_comparison_without_both(self):
        for rows in ([], [synthetic.row()], [synthetic.peer("cgal")],
                     [synthetic.row(), synthetic.peer("cgal", input={"name": "another"})]):
            self.assertTrue(peers.peers(frame_of(rows)).empty)


class Experiments(unittest.TestCase):
    FOUND = synthetic.experiment_verdicts(zero="withdrawn", one="holds", two="cannot_be_decided",
                                          three="does_not_hold", four="holds", five="not_resolved")

    def test_what_does_not_hold_comes_first(self):
        self.assertEqual(list(experiment_verdicts.table(self.FOUND)["claim"]),
                         ["three", "five", "one", "four", "two", "zero"])
        self.assertEqual(experiment_verdicts.counts(self.FOUND), "2 hold, 1 do not, 1 not resolved, "
                         "1 cannot be decided here; 1 withdrawn or superseded")

    def test_intervals_state_their_coverage_and_withdrawn_claims_their_successor(self):
        found = experiment_verdicts.table(self.FOUND).set_index("claim")
        self.assertEqual(found.loc["one", "interval"], "1.25 to 1.75, 75.0 % of 3 rounds")
        self.assertEqual(found.loc["zero", "reason"], "superseded by another: because of <zero>")

    def test_each_claim_is_printed_with_its_basis_or_as_withdrawn(self):
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            print_experiments(self.FOUND)
        self.assertNotIn("nan", printed.getvalue())
        self.assertIn("withdrawn          weak_scaling: zero: superseded by another", printed.getvalue())
        self.assertRegex(printed.getvalue(), r"does not hold      weak_scaling: .+ \(measured\): ")

    def test_without_any(self):
        self.assertTrue(experiment_verdicts.table(None).empty)
        self.assertEqual(experiment_verdicts.counts(None), "")


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
        # 1000 misses for the image, 20 per insertion.
        table = cache.cache(frame_of([self.counted(number, 1000 + 20 * number, "perf_event")
                                      for number in (500, 200, 900)]))
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


class Drawing(unittest.TestCase):
    def test_every_line_is_published_measured_or_simulated(self):
        rows = [synthetic.row(), synthetic.row(cores=2), *synthetic.like_the_paper(paper.table1(), executor="virtual")]
        series = scaling.weak_series(frame_of(rows))
        for draw in (fig4a.fig4a, fig4b.fig4b):
            figure = draw(series)
            legends = [axes.get_legend() for axes in figure.axes if axes.get_legend()]
            words = {text.get_text() for legend in legends for text in legend.get_texts()}
            size = "simulated, 3\N{NO-BREAK SPACE}M cells per core"
            self.assertTrue({"PODM, paper", "PODM, measured", f"PODM, {size}", f"PDR.PODM, {size}"} <= words, words)
            self.assertNotIn("PDR.PODM, measured", words)
            self.assertIn("order statistics", figure.get_label())

    def test_figures_without_rows_show_the_paper(self):
        made = outcome.make(frame_of([]))
        self.assertEqual(set(made.figures), {"fig4a", "fig4b"})
        self.assertIn("no verified", made.figures["fig4a"].get_label())
        self.assertEqual(set(made.missing),
                         {"fig1", "fig2b", "deviation", "lost", "distributed", "dihedral", "solvers", "pareto",
                          "corpus"})

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
