"""Tests simulated sizes side by side, and the section on the simulated machine, from synthetic rows."""
import re
import unittest

import paths  # noqa: F401
import synthetic
from figures import ablation, deviation, lost, machine, outcome, paper, scaling, simulated_sizes, style, validation
from report_page.first_screen import scales
from report_page.limits import limits
from test_figures import frame_of

SIZES = (40_000, 160_000, 640_000)


def rows_of(sizes=SIZES, **changes):
    """Yields speed-ups 0.6 cores - 10 x with x = (cells per core)^(-1/3); 1 - x / 2 of accesses stay on the node."""
    for size in sizes:
        x = size ** (-1 / 3)
        yield from synthetic.simulated_size(size, lambda algorithm, cores: 0.6 * cores - 10 * x, zero_hops=1 - x / 2,
                                            **changes)


def series_of(rows):
    return scaling.weak_series(frame_of(rows))


class Sizes(unittest.TestCase):
    def test_each_size_is_over_one_core_of_its_own(self):
        rows = [row for size in SIZES for row in rows_of([size])]
        for row in rows:  # cores of larger meshes are faster
            row["virtual"]["phases_s"]["refine"] /= row["cells"] / row["threads"]["used"]
        for one in scaling.simulated_sizes(series_of(rows)):
            x = one.cells_per_core ** (-1 / 3)
            self.assertAlmostEqual(one.table.loc["pdr-podm", 256]["speedup"], 0.6 * 256 - 10 * x)

    def test_a_size_without_its_base_is_in_no_series(self):
        rows = [row for row in rows_of() if row["threads"]["used"] > 1 or row["cells"] != SIZES[2]]
        self.assertEqual([one.cells_per_core for one in scaling.simulated_sizes(series_of(rows))], list(SIZES[:2]))

    def test_sizes_stand_side_by_side_and_none_beyond_them(self):
        rows = [row for row in rows_of() if row["cells"] < 1e8 or row["algorithm"] == "podm"]
        table = simulated_sizes.speedups(series_of(rows)).set_index("cores")
        line = table.loc[256]
        self.assertEqual(list(table.index), [32, 256])
        for size, x in (("40", 40e3 ** (-1 / 3)), ("160", 160e3 ** (-1 / 3))):
            self.assertEqual(line[f"PDR.PODM, not fitted: {size}\N{NO-BREAK SPACE}k"], f"{0.6 * 256 - 10 * x:.1f}")
        self.assertEqual(line["PDR.PODM, not fitted: 640\N{NO-BREAK SPACE}k"], "not simulated")
        self.assertEqual(line["PDR.PODM: paper"], "163.8")
        self.assertEqual(line["PDR.PODM, not fitted: greatest over least"], "1.00")
        self.assertFalse([name for name in table if "M" in name.partition(":")[2]])

    def test_the_dependence_on_the_size_is_stated_for_two_sizes_and_more(self):
        rows = [row for factor, size in zip((1, 2, 3), SIZES) for row in synthetic.simulated_size(
            size, lambda _, cores, factor=factor: factor * cores / 4)]
        said = simulated_sizes.depends_on_size(series_of(rows))
        self.assertIn("64, 128 and 192 times PODM on one core on 256 cores", said)
        self.assertIn("not simulated", said)
        self.assertIn("column is not fitted and depends on the cells per core: 64, 128 and 192 times",
                      scales(outcome.make(frame_of(rows))))
        self.assertEqual(simulated_sizes.depends_on_size(series_of(rows_of(SIZES[:1]))), "")

    def test_seeds_are_compared_seed_by_seed(self):
        rows = [{**row, "seed": seed, "trial": f"{row['trial']},seed={seed}"} for seed in range(1, 6)
                for row in synthetic.simulated_size(40_000, lambda _, cores, seed=seed: cores * seed / 10)]
        for row in rows:  # a slow seed is slow on any number of cores
            row["virtual"]["phases_s"]["refine"] *= row["seed"]
        (one,) = scaling.simulated_sizes(series_of(rows))
        line = one.table.loc["podm", 256]
        self.assertEqual((line["n"], round(line["speedup"], 6)), (5, 76.8))
        self.assertEqual((round(line["speedup_low"], 6), round(line["speedup_high"], 6)), (25.6, 128.0))
        self.assertIn("[25.6, 128.0]", simulated_sizes.speedups([one]).iloc[-1]["PODM, fitted: 40\N{NO-BREAK SPACE}k"])

    def test_rows_of_two_models_are_in_no_series_together(self):
        def of(model, sizes):
            for row in rows_of(sizes):
                row["virtual"].update(machine={"name": "Synthetic", "sha256": "ab" * 32}, **model)
                yield row

        rows = [*of({}, SIZES[:1]), *of({"model_sha256": "cd" * 32}, SIZES[1:])]
        sizes = scaling.simulated_sizes(series_of(rows))
        self.assertEqual([one.cells_per_core for one in sizes], list(SIZES[1:]))
        self.assertIn("model cdcdcdcd", sizes[0].key["machine"])

    def test_claims_are_judged_size_by_size(self):
        faster = {40_000: {128: 0.5, 256: 2.0}, 160_000: {128: 2.0, 256: 2.0}}
        rows = [row for size, by_cores in faster.items() for row in synthetic.simulated_size(
            size, lambda algorithm, cores, by_cores=by_cores: cores / 4 * (by_cores[cores] if algorithm == "pdr-podm"
                                                                           else 1), counts=(1, 128, 256))]
        claims = {one["claim"]: one["value"] for one in outcome.make(frame_of(rows)).verdicts["claims"]
                  if one["basis"] == "simulated"}
        self.assertEqual(claims["crossover, 40\N{NO-BREAK SPACE}k cells per core"], [128, 256])
        self.assertEqual(claims["crossover, 160\N{NO-BREAK SPACE}k cells per core"], [1, 128])

    def test_shares_without_a_hop_are_judged_number_of_cores_by_number_of_cores(self):
        published = paper.table2().loc[0]
        for worse, agree in ((1.5, 7), (3.0, 0)):
            rows = list(synthetic.simulated_size(40_000, lambda _, cores: cores, counts=(1, *published.index)))
            for row in rows:
                cores = row["threads"]["used"]
                if cores > 16:
                    remote = worse * (1 - published[cores])
                    row.update(hops=[int(1e9 * (1 - remote)), int(1e9 * remote)], leaves={"nodes": cores // 16})
            claim = next(one for one in outcome.make(frame_of(rows)).verdicts["claims"]
                         if one["claim"] == "zero-hop share by number of cores" and one["basis"] == "simulated")
            self.assertEqual((claim["value"], claim["paper"]), (agree, 7))
            self.assertEqual(claim["verdict"], "agrees" if agree == 7 else "differs")


class FittedShares(unittest.TestCase):
    def test_the_greatest_share_on_several_blades_counts(self):
        rows = list(synthetic.with_losses(rows_of(SIZES[:1]), compute=0.6, memory_remote=0.1, network_queue=0.2))
        for row in rows:
            if row["threads"]["used"] == 256 and row["algorithm"] == "pdr-podm":
                row["virtual"]["worker_s"]["network_queue"] *= 0
        frame = frame_of(rows)
        table = simulated_sizes.fitted_shares(frame, scaling.weak_series(frame)).set_index("algorithm")
        self.assertAlmostEqual(table.loc["podm", "network_queue"], 0.2 / 0.9)
        self.assertAlmostEqual(table.loc["pdr-podm", "memory_remote"], 0.1 / 0.7)
        self.assertEqual(table.loc["pdr-podm", "n"], 2)
        self.assertIn("fitted_shares", outcome.make(frame).tables)
        self.assertTrue(simulated_sizes.fitted_shares(frame_of(rows_of()), series_of(rows_of())).empty)


class Ablation(unittest.TestCase):
    RATES = {("podm", 1): 0.1, ("podm", 16): 1.6, ("pdr-podm", 16): 1.0, ("podm", 128): 9.0, ("pdr-podm", 128): 5.0,
             ("podm", 256): 4.47, ("pdr-podm", 256): 8.0, ("podm-home", 256): 20.0}

    def rows(self, factor=None, rates=None, zero_hops=None):
        """Yields rows with these rates, million cells per second by algorithm and cores."""
        for (algorithm, cores), rate in {**self.RATES, **(rates or {})}.items():
            made = synthetic.row(algorithm, cores, experiment="simulated_ablation", executor="virtual", cells=1_000_000,
                                 phases_s={"refine": 1 / rate}, asked={"cost_factor": factor} if factor else {})
            share = (zero_hops or {"podm": 0.2, "pdr-podm": 0.9}).get(algorithm, 0.5)
            made["hops"] = [int(1e6 * share), int(1e6 * (1 - share))]
            yield made

    def lines(self, *groups):
        table = ablation.readable(ablation.ablation(frame_of([row for group in groups for row in group])))
        return table.set_index("constant")

    def test_all_holds_as_they_are_and_survives_what_changes_nothing(self):
        shown = self.lines(self.rows(), self.rows("wake=0"), self.rows("wake=2"))
        self.assertEqual(set(shown.loc["as they are"].iloc[1:]), {"holds"})
        self.assertEqual(set(shown.loc["wake"].iloc[1:]), {"survives"})
        self.assertEqual(shown.loc["wake", "rows"], 2 * len(self.RATES))

    def test_what_falls_names_its_factors(self):
        shown = self.lines(self.rows("retries=0", {("podm", 256): 18.0}), self.rows("retries=2"), self.rows(),
                           self.rows("core_speed=0.5", zero_hops={"podm": 0.9, "pdr-podm": 0.2}))
        line = shown.loc["retries"]
        for statement in ("PDR.PODM ahead on 256", "PODM slower on 256 than on 128",
                          "PODM on 256 within 8 % of the paper's 44.7, the fit"):
            self.assertEqual(line[statement], "falls: off")
        self.assertEqual(line["PODM ahead on 128"], "survives")
        hops = shown.loc["core speed", ablation.FINDINGS[-1].statement]
        self.assertEqual(hops, "falls: halved")

    def test_a_finding_that_does_not_hold_may_come_back_and_cannot_fall(self):
        behind = {("pdr-podm", 256): 3.0}
        shown = self.lines(self.rows(rates=behind), self.rows("wake=0", behind), self.rows("wake=2"))
        self.assertEqual(shown.loc["as they are", "PDR.PODM ahead on 256"], "does not hold")
        self.assertEqual(shown.loc["wake", "PDR.PODM ahead on 256"], "holds: doubled")

    def test_what_lacks_rows_was_not_simulated(self):
        part = [row for row in self.rows("wake=0") if row["threads"]["used"] < 256]
        shown = self.lines(self.rows(), part)
        self.assertEqual(shown.loc["wake", "PDR.PODM ahead on 256"], "not simulated")
        self.assertEqual(shown.loc["wake", "PODM ahead on 128"], "survives")
        self.assertTrue(ablation.ablation(frame_of([synthetic.row()])).empty)
        self.assertEqual(set(self.lines(part).loc["wake"].iloc[1:]), {"not simulated"}, "nothing to compare with")

    def test_altered_and_unproved_rows_give_no_other_number(self):
        altered = list(self.rows("wake=0"))
        self.assertEqual(scaling.weak_series(frame_of(altered)), [])
        unproved = [{**row, "status": "unmet"} for row in self.rows()]
        self.assertTrue(ablation.ablation(frame_of(unproved)).empty)


class Machine(unittest.TestCase):
    def test_the_papers_own_speedups_deviate_by_nothing(self):
        published = paper.corrected_table1()["speedup"]
        rows = [row for size in SIZES for row in synthetic.simulated_size(size, lambda *index: published[index],
                                                                          counts=(1, 32, 64, 128, 160, 256))]
        table = deviation.deviation(series_of(rows))
        self.assertEqual(len(table), 2 * 5 * 3, "each algorithm and number of cores, three sizes")
        self.assertTrue((table["deviation"].abs() < 1e-9).all())
        self.assertEqual(list(deviation.means(table)["speed-up was"].unique()), ["fitted", "not fitted"])

    def test_a_deviation_has_its_sign_and_counts_without_it(self):
        published = paper.corrected_table1()["speedup"]
        off = {32: 1.1, 256: 0.8}
        rows = synthetic.simulated_size(40_000, lambda *index: published[index] * off[index[1]])
        table = deviation.deviation(series_of(rows)).query("algorithm == 'podm'")
        self.assertEqual([round(one, 6) for one in table["deviation"]], [0.1, -0.2])
        self.assertEqual(list(deviation.means(table)["mean absolute deviation %"]), ["15.0"])

    def test_losses_are_worker_microseconds_per_cell_and_those_without_a_cause_are_outside(self):
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

    def test_older_rows_record_no_losses_and_no_machine(self):
        made = outcome.make(frame_of(rows_of()))
        self.assertIn("virtual.worker_s", made.missing["lost"])
        self.assertFalse({"lost", "machine"} & set(made.tables))
        self.assertIn("deviation", made.figures)

    def test_constants_are_listed_by_machine(self):
        rows = list(rows_of(SIZES[:1]))
        for one in rows:
            one["virtual"]["machine"] = {"name": "Synthetic", "path": "synthetic.toml", "sha256": "ab" * 32,
                                         "constants": {"core_speed": 0.15, "retries": 0.0}}
        (line,) = machine.machine(frame_of(rows)).to_dict("records")
        self.assertEqual((line["name"], line["rows"]), ("Synthetic", len(rows)))
        self.assertEqual(line["constants"], "core_speed = 0.15, retries = 0")

    def test_limits_are_those_of_the_readme(self):
        text = limits()
        self.assertGreaterEqual(text.count("<li>"), 3)
        self.assertIn("never joined", text)
        self.assertNotIn("crossover of PODM", text, "the next section is not one of them")
        self.assertFalse(re.search(r"\*\*|\]\(", text))


class AtHome(unittest.TestCase):
    """Tests PODM at home, which the paper does not have, beside the paper's two algorithms."""
    ALL = ("podm", "pdr-podm", "podm-home")
    SPEEDUPS = {"podm": 0.2, "pdr-podm": 0.6, "podm-home": 0.8}

    def made(self, algorithms):
        rows = [row for size in SIZES for row in synthetic.simulated_size(
            size, lambda algorithm, cores: self.SPEEDUPS[algorithm] * cores, zero_hops=0.9, algorithms=algorithms)
            if row["algorithm"] != "podm-home" or row["threads"]["used"] > 1]
        return outcome.make(frame_of(synthetic.with_losses(rows, compute=0.5, contention=0.25)))

    def told(self, made):
        """Returns all text of figures and tables by name; if both have a name, the figure's text."""
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
            self.assertIn(style.BEYOND, told[name])
        lines = made.tables["table1"][0].query("algorithm == 'podm-home'")
        self.assertEqual(list(zip(lines["basis"], lines["cores"])), [
            ("simulated", 32), ("simulated", 256)])
        self.assertTrue(all(abs(lines["efficiency"] - 0.8) < 1e-9))
        order = made.tables["table1"][1].query("cores == 256")["algorithm"].drop_duplicates()
        self.assertEqual(tuple(order), self.ALL)
        self.assertEqual(set(made.tables["table2"][0].query("algorithm == 'podm-home'")["basis"]),
                         {"simulated"})
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
        sizes = {"used": {"radius_mm": 3.0, "delta_mm": 1.5}, "input": {"name": "synthetic"}, "cells": 1_000_000,
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
