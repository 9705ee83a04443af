"""What simulated sizes extrapolate to, and the section on the simulated machine, from made-up rows."""
import math
import re
import unittest

import paths  # noqa: F401
import synthetic
from figures import (deviation, extrapolation, lost, machine, outcome, paper, scaling, style, table1, table2,
                     validation)
from report_page.first_screen import scales
from report_page.limits import limits
from test_figures import frame_of

SIZES = (40_000, 160_000, 640_000)


def rows_of(sizes=SIZES, **changes):
    """Speed-ups on the line 0.6 cores - 10 x of x = (cells a core)^(-1/3), and 1 - x / 2 of accesses on the node."""
    for size in sizes:
        x = size ** (-1 / 3)
        yield from synthetic.simulated_size(size, lambda algorithm, cores: 0.6 * cores - 10 * x, zero_hops=1 - x / 2,
                                            **changes)


def series_of(rows):
    return scaling.weak_series(frame_of(rows))


class Extrapolation(unittest.TestCase):
    X = 3e6 ** (-1 / 3)

    def test_a_line_through_all_sizes_is_met_and_has_no_spread(self):
        value, low, high = extrapolation.at_paper_size(SIZES, [7 - 3 * size ** (-1 / 3) for size in SIZES])
        for one in (value, low, high):
            self.assertAlmostEqual(one, 7 - 3 * self.X)

    def test_sizes_that_lie_on_no_line_have_an_interval_around_the_value(self):
        value, low, high = extrapolation.at_paper_size(SIZES, [1, 2, 2.5])
        self.assertTrue(low < value < high)

    def test_two_sizes_have_no_interval_and_one_no_value(self):
        value, low, high = extrapolation.at_paper_size(SIZES[:2], [1, 2])
        self.assertTrue(value > 2 and math.isnan(low) and math.isnan(high))
        self.assertTrue(math.isnan(extrapolation.at_paper_size(SIZES[:1], [1])[0]))

    def test_speedups_and_shares_are_extrapolated_and_the_rest_follows(self):
        frame = frame_of(rows_of())
        one = scaling.first_of(scaling.weak_series(frame), "extrapolated")
        line = one.table.loc["pdr-podm", 256]
        self.assertAlmostEqual(line["speedup"], 0.6 * 256 - 10 * self.X)
        self.assertAlmostEqual(line["efficiency"], line["speedup"] / 256)
        self.assertAlmostEqual(line["cells"] / line["seconds"] / 1e5, line["speedup"])
        self.assertEqual((line["n"], one.cells_per_core), (3, 3e6))
        shares = table2.table2(frame).set_index(["basis", "algorithm", "cores", "hops"])["share"]
        self.assertAlmostEqual(shares["extrapolated", "pdr-podm", 256, 0], 1 - self.X / 2, places=6)
        self.assertAlmostEqual(sum(shares["extrapolated", "pdr-podm", 256, hops] for hops in (0, 1)), 1)

    def test_shares_stay_shares(self):
        rows = [row for size, zero in zip(SIZES, (0.5, 0.9, 0.999))
                for row in synthetic.simulated_size(size, lambda _, cores: cores, zero_hops=zero)]
        table = table2.table2(frame_of(rows)).query("basis == 'extrapolated'")
        self.assertTrue(len(table) and table[["share", "share_low", "share_high"]].stack().between(0, 1).all())

    def test_one_size_gives_nothing(self):
        frame = frame_of(rows_of(SIZES[:1]))
        series = scaling.weak_series(frame)
        self.assertEqual(scaling.bases_of(series), ("measured", "simulated"))
        self.assertNotIn("extrapolated", set(table2.table2(frame)["basis"]))

    def test_nothing_is_extrapolated_from_few_cells_a_core(self):
        frame = frame_of(rows_of((2_000, 10_000, *SIZES[:2])))
        self.assertEqual(scaling.first_of(scaling.weak_series(frame), "extrapolated").sizes, SIZES[:2])
        self.assertEqual(set(table2.table2(frame).query("basis == 'extrapolated'")["n"]), {2})
        self.assertEqual(scaling.bases_of(series_of(rows_of((2_000, 10_000)))), ("measured", "simulated"))

    def test_sizes_of_other_machines_experiments_and_images_are_left_out(self):
        other = synthetic.row()["environment"] | {"cpu": "Another"}
        shown = list(rows_of(SIZES[1:]))
        for changes in ({"environment": other}, {"programs": {}}):
            rows = [*shown, *rows_of(SIZES[:1], **changes)]
            self.assertEqual(scaling.first_of(series_of(rows), "extrapolated").sizes, SIZES[1:])
        rows = [*shown, *({**row, "experiment": "another"} for row in rows_of(SIZES[:1]))]
        self.assertEqual(scaling.first_of(series_of(rows), "extrapolated").sizes, SIZES[1:])
        rows = [*shown, *({**row, "input": {"name": "phantom:other@64"}} for row in rows_of(SIZES[:1]))]
        self.assertEqual(scaling.first_of(series_of(rows), "extrapolated").sizes, SIZES[1:])

    def test_hops_of_rows_whose_cells_do_not_grow_are_no_size(self):
        fixed = [{**row, "cells": 500_000, "trial": f"fixed,threads={row['threads']['used']}"}
                 for row in rows_of(SIZES[:1])]
        rows = [*rows_of(SIZES[1:]), *fixed]
        self.assertEqual(set(table2.table2(frame_of(rows)).query("basis == 'extrapolated'")["n"]), {2})

    def test_nothing_measured_is_extrapolated(self):
        rows = [synthetic.row(cells=cells, trial=f"{cells},threads=1") for cells in (300_000, 3_000_000)]
        self.assertIsNone(scaling.first_of(series_of(rows), "extrapolated"))

    def test_table_1_shows_the_largest_size_and_the_extrapolation_marked(self):
        shown = table1.readable(table1.table1(series_of(rows_of())))
        on_256 = shown[(shown["cores"] == 256) & (shown["algorithm"] == "podm")]
        self.assertEqual(list(on_256["basis"]), [
            "published", "simulated, 640\N{NO-BREAK SPACE}k cells a core",
            "extrapolated from simulation, 3\N{NO-BREAK SPACE}M cells a core"])
        self.assertTrue(on_256["speed-up"].iloc[2].startswith(table1.MARKS["extrapolated"]))


class Machine(unittest.TestCase):
    def test_the_papers_own_speedups_deviate_by_nothing(self):
        published = paper.corrected_table1()["speedup"]
        rows = [row for size in SIZES for row in synthetic.simulated_size(size, lambda *index: published[index],
                                                                          counts=(1, 32, 64, 128, 160, 256))]
        table = deviation.deviation(series_of(rows))
        self.assertEqual(len(table), 2 * 5 * 4, "each algorithm and number of cores, three sizes and what follows")
        self.assertTrue((table["deviation"].abs() < 1e-9).all())
        self.assertEqual(list(deviation.means(table)["speed-up was"].unique()), ["fitted", "predicted"])

    def test_a_deviation_has_its_sign_and_counts_without_it(self):
        published = paper.corrected_table1()["speedup"]
        off = {32: 1.1, 256: 0.8}
        rows = synthetic.simulated_size(40_000, lambda *index: published[index] * off[index[1]])
        table = deviation.deviation(series_of(rows)).query("algorithm == 'podm'")
        self.assertEqual([round(one, 6) for one in table["deviation"]], [0.1, -0.2])
        self.assertEqual(list(deviation.means(table)["mean absolute deviation %"]), ["15.0"])

    def test_losses_are_worker_microseconds_a_cell_and_what_no_cause_tells_is_outside(self):
        rows = list(synthetic.with_losses(rows_of(SIZES[:1]), compute=0.5, network_queue=0.2))
        frame = frame_of(rows)
        table = lost.lost(frame, scaling.weak_series(frame)).set_index(["algorithm", "cores"])
        self.assertAlmostEqual(table.loc[("podm", 1), "compute"], 5.0)
        line = table.loc[("pdr-podm", 256)]
        self.assertAlmostEqual(line["network_queue"] / line["compute"], 0.4)
        self.assertAlmostEqual(line["outside"] / line["compute"], 0.6)
        self.assertIn("Where the time goes", outcome.make(frame).figures["lost"].get_label())

    def test_a_cause_of_another_name_is_shown(self):
        frame = frame_of(synthetic.with_losses(rows_of(SIZES[:1]), compute=0.5, odd_cause=0.25))
        shown = lost.readable(lost.lost(frame, scaling.weak_series(frame)))
        self.assertEqual(list(shown)[-3:], ["computing", "odd cause", "outside refinement, or idle"])

    def test_older_rows_tell_no_losses_and_no_machine(self):
        made = outcome.make(frame_of(rows_of()))
        self.assertIn("virtual.worker_s", made.missing["lost"])
        self.assertFalse({"lost", "machine"} & set(made.tables))
        self.assertIn("deviation", made.figures)

    def test_constants_are_told_by_machine(self):
        rows = list(rows_of(SIZES[:1]))
        for one in rows:
            one["virtual"]["machine"] = {"name": "Made-up", "path": "made-up.toml", "sha256": "ab" * 32,
                                         "constants": {"core_speed": 0.15, "retries": 0.0}}
        (line,) = machine.machine(frame_of(rows)).to_dict("records")
        self.assertEqual((line["name"], line["rows"]), ("Made-up", len(rows)))
        self.assertEqual(line["constants"], "core_speed = 0.15, retries = 0")

    def test_limits_are_those_of_the_readme(self):
        text = limits()
        self.assertGreaterEqual(text.count("<li>"), 3)
        self.assertIn("never joined", text)
        self.assertNotIn("crossover of PODM", text, "the next section is not one of them")
        self.assertFalse(re.search(r"\*\*|\]\(", text))


class AtHome(unittest.TestCase):
    """PODM at home, which the paper does not have, beside its two."""
    ALL = ("podm", "pdr-podm", "podm-home")
    SPEEDUPS = {"podm": 0.2, "pdr-podm": 0.6, "podm-home": 0.8}

    def made(self, algorithms):
        rows = [row for size in SIZES for row in synthetic.simulated_size(
            size, lambda algorithm, cores: self.SPEEDUPS[algorithm] * cores, zero_hops=0.9, algorithms=algorithms)
            if row["algorithm"] != "podm-home" or row["threads"]["used"] > 1]
        return outcome.make(frame_of(synthetic.with_losses(rows, compute=0.5, contention=0.25)))

    def told(self, made):
        """All that figures and tables say, by name; a name of both is the figure's."""
        figures = {name: [one.get_label(), *(axes.get_title() + axes.get_xlabel() for axes in one.axes),
                          *(text.get_text() for axes in one.axes if axes.get_legend()
                            for text in axes.get_legend().get_texts())] for name, one in made.figures.items()}
        tables = {name: [*shown, *shown.astype(str).to_numpy().ravel()] for name, (_, shown) in made.tables.items()}
        return {name: "\n".join(words) for name, words in {**tables, **figures}.items()}

    def test_it_is_a_series_of_its_own_in_each_simulated_block(self):
        made = self.made(self.ALL)
        told = self.told(made)
        for name in ("fig4a", "fig4b", "lost"):
            self.assertIn("PODM at home", told[name], name)
        for name in ("fig4a", "fig4b"):
            self.assertIn("PODM at home, simulated, 640\N{NO-BREAK SPACE}k", told[name])
            self.assertIn("PODM at home, extrapolated", told[name])
            self.assertIn(style.BEYOND, told[name])
        lines = made.tables["table1"][0].query("algorithm == 'podm-home'")
        self.assertEqual(list(zip(lines["basis"], lines["cores"])), [
            (basis, cores) for cores in (32, 256) for basis in ("simulated", "extrapolated")])
        self.assertTrue(all(abs(lines["efficiency"] - 0.8) < 1e-9))
        order = made.tables["table1"][1].query("cores == 256")["algorithm"].drop_duplicates()
        self.assertEqual(tuple(order), self.ALL)
        self.assertEqual(set(made.tables["table2"][0].query("algorithm == 'podm-home'")["basis"]),
                         {"simulated", "extrapolated"})
        self.assertIn("podm-home", set(made.tables["lost"][0]["algorithm"]))
        self.assertIn("PODM at home, 0 hops", told["efficiency_and_hops"])
        self.assertNotIn("PODM at home, efficiency, published", told["efficiency_and_hops"])

    def test_it_appears_nowhere_without_rows(self):
        for name, words in self.told(self.made(self.ALL[:2])).items():
            self.assertNotIn("home", words, name)

    def test_it_changes_no_verdict_and_no_number_of_the_others(self):
        made, without = self.made(self.ALL), self.made(self.ALL[:2])
        self.assertEqual(made.verdicts, without.verdicts)
        for name in ("table1", "deviation", "lost"):
            others = made.tables[name][0].query("algorithm != 'podm-home'").reset_index(drop=True)
            self.assertTrue(others.equals(without.tables[name][0]), name)

    def test_bars_and_colours_are_apart(self):
        for names in (style.COLOURS, style.MARKERS):
            self.assertEqual(len(set(names.values())), 3)
        axes = self.made(self.ALL).figures["fig4b"].axes[1]
        self.assertIn("PDR.PODM, PODM, PODM at home", axes.get_xlabel())
        bars = axes.patches
        places = sorted({(round(bar.get_x(), 6), round(bar.get_x() + bar.get_width(), 6)) for bar in bars})
        self.assertEqual(len(places), 2 * 3 + 2, "three of 32 and of 256 cores, two of one")
        self.assertTrue(all(left[1] < right[0] for left, right in zip(places, places[1:])), places)

    def test_the_first_screen_has_a_bar_of_a_measured_one(self):
        rows = [synthetic.row(algorithm, cores) for algorithm in ("podm", "podm-home") for cores in (1, 2)]
        self.assertIn("PODM at home, 2 cores", scales(outcome.make(frame_of(rows))))


class Validation(unittest.TestCase):
    def rows(self, algorithm="podm", slower=1.2):
        sizes = {"used": {"radius_mm": 3.0, "delta_mm": 1.5}, "input": {"name": "made-up"}, "cells": 1_000_000,
                 "overhead_s": {"contention": 1.0, "begging": 0.0, "rollback": 0.5}}
        for cores in (1, 2):
            seconds = {"transform": 2.0, "refine": 24.0 / cores}
            yield synthetic.row(algorithm, cores, trial=f"threads-1M,threads={cores}", phases_s=seconds, **sizes)
            seconds = {phase: slower * one for phase, one in seconds.items()}
            virtual = {"cost": "measured", "refine_s": 1.0, "phases_s": seconds}
            yield synthetic.row(algorithm, cores, trial=f"virtual-1M,threads={cores}", executor="virtual",
                                virtual=virtual, **sizes)

    def test_the_same_mesh_is_compared_stage_by_stage(self):
        table = validation.validation(frame_of(self.rows())).set_index("cores")
        for name in ("seconds", "refine", "transform"):
            self.assertAlmostEqual(table.loc[2, name], 0.2)
        self.assertAlmostEqual(table.loc[2, "speedup"], table.loc[2, "measured_speedup"])
        self.assertAlmostEqual(table.loc[2, "measured_lost"], 1.5 / 24)
        self.assertAlmostEqual(table.loc[2, "lost"], 1.5 / 24 / 1.2)
        self.assertEqual(len(validation.readable(table.reset_index())), 2)

    def test_nothing_is_compared_across_meshes(self):
        rows = list(self.rows())
        for one in rows:
            if one["basis"] == "simulated":
                one["used"] = {"radius_mm": 2.0, "delta_mm": 1.0}
        self.assertTrue(validation.validation(frame_of(rows)).empty)
        self.assertTrue(validation.validation(frame_of([])).empty)


if __name__ == "__main__":
    unittest.main()
