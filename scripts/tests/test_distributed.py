"""Tests ranks that share no memory: tables, the extrapolation and the figure, from synthetic rows."""
import math
import unittest

import paths  # noqa: F401
import pandas
import synthetic
from figures import distributed, distributed_figure, distributed_model, outcome, scaling
from report_page import page
from test_figures import frame_of

SIZES = (100_000, 300_000, 1_000_000)


def spent(**seconds):
    """Returns the phases of a rank: computing seconds, or (computing, waiting, network)."""
    every = {phase: one if isinstance(one, tuple) else (one, 0.0, 0.0) for phase, one in seconds.items()}
    return {phase: dict(zip(("computing_s", "waiting_s", "network_s"), one)) for phase, one in every.items()}


def row(ranks, per_rank=100_000, by_rank=None, basis="simulated", cells=None, **changes):
    """Returns a row of ranks. By default all ranks spend the same, one microsecond of refining per cell."""
    cells = cells or per_rank * ranks
    even = spent(transform=0.0, refine=1e-6 * per_rank, extract=0.0, measure=5.0)
    told = {"number": ranks, "imbalance": 1.1, "rounds": [{"deferred": cells // 50}, {"deferred": 0}][:ranks],
            "by_rank": [{"cells": cells // ranks, "spent": one} for one in by_rank or [even] * ranks]}
    made = synthetic.row(cores=ranks, cells=cells, experiment="distributed_weak", trial=f"synthetic,ranks={ranks}",
                         asked={"ranks": ranks, "target_elements": per_rank * ranks}, ranks=told,
                         resolved={"cells": cells}, process={"bytes_per_cell_beyond_image": 150.0}, **changes)
    return {**made, "basis": basis}


def modelled(ranks, per_rank, volume=1.0, surface=20.0, once=0.0):
    """Returns a row of ranks whose refining costs microseconds per cell by volume, later rounds by surface, the
    transform once."""
    x = per_rank ** (-1 / 3)
    phases = {"transform": once, "refine": 1e-6 * per_rank * volume, "extract": 0.0}
    if ranks > 1:
        phases["later"] = 1e-6 * per_rank * surface * x
    return row(ranks, per_rank, [spent(**phases)] * ranks)


def table_of(rows):
    return distributed.distributed(frame_of(rows))


class Rows(unittest.TestCase):
    def test_simulated_efficiency_is_that_of_the_rank_that_comes_last(self):
        slow, waiting = spent(refine=0.2, exchange=0.05), spent(refine=0.1, exchange=(0.02, 0.04, 0.05))
        table = table_of([row(1), row(2, by_rank=[slow, waiting])]).set_index("ranks")
        self.assertAlmostEqual(table.loc[1, "refining_efficiency"], 1)
        self.assertAlmostEqual(table.loc[2, "refining_efficiency"], 0.1 / 0.25)
        self.assertAlmostEqual(table.loc[2, "refine"], 1.5)
        self.assertAlmostEqual(table.loc[2, "waiting"], 0.2)
        self.assertAlmostEqual(table.loc[2, "network"], 0.25)

    def test_others_wait_for_the_first_ranks_coarse_mesh_and_learn_it(self):
        first = spent(initial=(0.03, 0.0, 0.01), refine=(0.1, 0.0, 0.0))
        other = spent(initial=(0.02, 0.03, 0.01), refine=(0.1, 0.0, 0.0))
        line = table_of([row(1), row(4, by_rank=[first, other, other, other])]).set_index("ranks").loc[4]
        self.assertAlmostEqual(line["initial"], 0.3)
        self.assertAlmostEqual(line["learn"], (0.04 + 3 * 0.06) / 4 / 0.1 - 0.3)
        self.assertEqual((line["waiting"], line["network"]), (0, 0))

    def test_seeds_are_nothing_to_be_learnt(self):
        seeding = spent(initial=(0.02, 0.01, 0.0), refine=(0.1, 0.0, 0.0))
        seeded = row(4, by_rank=[seeding] * 4)
        for rank in seeded["ranks"]["by_rank"]:
            rank["seed_vertices"] = 1000
        line = table_of([row(1), seeded]).set_index("ranks").loc[4]
        self.assertAlmostEqual(line["initial"], 0.3)
        self.assertEqual(line["learn"], 0)

    def test_measured_efficiency_is_of_processor_seconds_and_waiting_does_not_count(self):
        waiting = spent(refine=0.1, exchange=(0.1, 99.0, 0.0))
        table = table_of([row(1, basis="measured"), row(2, by_rank=[waiting] * 2, basis="measured")]).set_index("ranks")
        self.assertAlmostEqual(table.loc[2, "refining_efficiency"], 0.5)
        self.assertTrue(math.isnan(table.loc[2, "waiting"]))
        self.assertEqual(table.loc[2, "rank_bytes_per_cell"], 150)

    def test_measuring_the_mesh_is_no_part_and_transform_and_pieces_are_of_the_whole_alone(self):
        whole = spent(transform=0.05, refine=0.1, extract=0.05, measure=77.0)
        table = table_of([row(1), row(4, by_rank=[whole] * 4)]).set_index("ranks")
        self.assertAlmostEqual(table.loc[4, "refining_efficiency"], 1)
        self.assertAlmostEqual(table.loc[4, "efficiency"], 0.5)

    def test_bases_and_sizes_are_never_joined(self):
        rows = [row(1), row(2), row(1, basis="measured"), row(4, basis="measured"), row(8, 300_000)]
        table = table_of(rows)
        self.assertEqual(len(table), 5)
        eight = table[table["ranks"] == 8].iloc[0]
        self.assertTrue(math.isnan(eight["refining_efficiency"]), "one rank has other cells")

    def test_rows_that_did_not_verify_count_nowhere(self):
        wrong = row(2, verdicts={**synthetic.PASSED, "conformity": "fail"})
        self.assertEqual(list(table_of([row(1), wrong])["ranks"]), [1])
        self.assertEqual(list(table_of([row(1), row(2, warmup=True)])["ranks"]), [1])

    def test_other_builds_are_left_out(self):
        older = row(2, programs={"podm": {"sha256": "ab" * 32}, "podm_mpi": {"sha256": "cd" * 32}})
        self.assertEqual(list(table_of([older, row(1)])["ranks"]), [1])

    def test_ranks_are_in_no_series_of_threads(self):
        frame = frame_of([row(1), row(2), row(1, basis="measured")])
        self.assertEqual(scaling.weak_series(frame), [])
        self.assertTrue(table_of([synthetic.row()]).empty)


class Extrapolation(unittest.TestCase):
    def extrapolated(self, sizes=SIZES, counts=(1, 8, 64), **costs):
        return distributed_model.extrapolated(table_of(
            [modelled(ranks, size, **costs) for size in sizes for ranks in counts]))

    def test_costs_of_the_model_are_met_at_20_million(self):
        table = self.extrapolated().set_index(["ranks", "threads"])
        expected = 1 / (1 + 20 * 2e7 ** (-1 / 3))
        for ranks in (8, 64):
            line = table.loc[ranks, 1]
            for name in ("refining_efficiency", "refining_efficiency_low", "refining_efficiency_high"):
                self.assertAlmostEqual(line[name], expected, places=3)
            self.assertAlmostEqual(line["worst_miss"], 0, places=6)

    def test_waiting_along_edges_vanishes_sooner_than_along_faces(self):
        waits = [[row(1, size), row(8, size, [spent(refine=1e-6 * size, exchange=(0.0, 1e-6 * size * power(size), 0.0))
                                              ] * 8)]
                 for power in (lambda n: 1e4 * n ** (-2 / 3), lambda n: 1e2 * n ** (-1 / 3)) for size in SIZES]
        edges, faces = (distributed_model.extrapolated(table_of(sum(some, []))).iloc[0]["waiting"]
                        for some in (waits[:3], waits[3:]))
        self.assertAlmostEqual(edges, 1e4 * 2e7 ** (-2 / 3), places=4)
        self.assertAlmostEqual(faces, 1e2 * 2e7 ** (-1 / 3), places=4)

    def test_the_transform_of_one_image_vanishes(self):
        line = self.extrapolated(once=0.5).iloc[0]
        self.assertAlmostEqual(line["transform"], 0.5e6 / 2e7, places=4)
        self.assertLess(line["transform"], 0.5e6 / max(SIZES) / 10)

    def test_what_one_thread_does_weighs_more_on_nodes_of_many(self):
        rows = [row(1, size) for size in SIZES] + [
            row(8, size, [spent(exchange=0.1e-6 * size, refine=1e-6 * size)] * 8) for size in SIZES]
        table = distributed_model.extrapolated(table_of(rows)).set_index("threads")
        self.assertAlmostEqual(table.loc[1, "refining_efficiency"], 1 / 1.1, places=3)
        self.assertAlmostEqual(table.loc[16, "refining_efficiency"], 1 / (1 + 16 * 0.1), places=3)

    def test_sizes_on_no_line_have_an_interval_and_a_miss(self):
        rows = [row(1, size) for size in SIZES] + [
            row(8, size, [spent(refine=factor * 1e-6 * size)] * 8) for size, factor in zip(SIZES, (1.2, 1.9, 1.3))]
        line = distributed_model.extrapolated(table_of(rows)).iloc[0]
        self.assertLess(line["refining_efficiency_low"], line["refining_efficiency"])
        self.assertGreater(line["worst_miss"], 0.1)

    def test_nothing_is_derived_from_two_sizes(self):
        self.assertTrue(self.extrapolated(SIZES[:2]).empty)
        self.assertEqual(set(self.extrapolated()["n"]), {len(SIZES)})
        self.assertTrue(self.extrapolated(counts=(1, 2, 4)).empty)

    def test_one_rank_counts_at_all_its_sizes_and_too_few_cells_at_none(self):
        rows = [modelled(ranks, size) for size in SIZES for ranks in (1, 8)]
        odd = [row(1, 5_000_000, [spent(refine=50.0)]), row(1, 10_000, [spent(refine=9.0)]),
               row(8, 10_000, [spent(refine=9.0)] * 8)]
        plain, with_odd = (distributed_model.extrapolated(table_of(some)).iloc[0] for some in (rows, [*rows, *odd]))
        self.assertEqual(plain["sizes"], with_odd["sizes"])
        self.assertGreater(with_odd["refining_efficiency"], 2 * plain["refining_efficiency"])

    def test_nothing_measured_is_extrapolated(self):
        rows = [row(ranks, size, basis="measured") for size in SIZES for ranks in (1, 8)]
        self.assertTrue(distributed_model.extrapolated(table_of(rows)).empty)


class Shown(unittest.TestCase):
    def made(self):
        rows = [modelled(ranks, size) for size in SIZES for ranks in (1, 8, 64)]
        return outcome.make(frame_of([*rows, *(row(ranks, basis="measured") for ranks in (1, 2, 4))]))

    def test_tables_and_figure_are_there_and_distinguished(self):
        made = self.made()
        shown = made.tables["distributed"][1]
        self.assertEqual({one.split(",")[0] for one in shown["basis"]}, {"simulated", "measured processor seconds"})
        self.assertEqual(len(made.tables["distributed_extrapolated"][1]), 4)
        simulated, measured, parts = made.figures["distributed"].axes
        legends = [" ".join(text.get_text() for text in axes.get_legend().get_texts())
                   for axes in (simulated, measured)]
        self.assertIn("extrapolated", legends[0])
        self.assertNotIn("extrapolated", legends[1])
        self.assertIn("measured", measured.get_title())
        label = made.figures["distributed"].get_label()
        for words in ("Simulated", "Measured", "no confidence interval", "It is assumed"):
            self.assertIn(words, label)

    def test_there_is_a_panel_for_each_basis_that_has_rows(self):
        table, nodes = self.made().tables["distributed"][0], self.made().tables["distributed_extrapolated"][0]
        for basis, panels in (("simulated", 2), ("measured", 1)):
            drawn = distributed_figure.figure(table[table["basis"] == basis], nodes)
            self.assertEqual(len(drawn.axes), panels)
            self.assertTrue(all(axes.get_visible() for axes in drawn.axes))

    def test_bars_are_as_high_as_their_parts(self):
        table = self.made().tables["distributed"][0]
        parts = self.made().figures["distributed"].axes[2]
        tops = {round(bar.get_y() + bar.get_height(), 6) for bar in parts.patches}
        sums = table[table["basis"] == "simulated"][list(distributed.PARTS)].fillna(0).sum(axis=1)
        self.assertLessEqual({round(one, 6) for one in sums}, tops)

    def test_each_part_has_a_model_words_and_a_colour(self):
        for names in (distributed_model.MODEL, distributed_figure.COLOURS):
            self.assertEqual(set(names), set(distributed.PARTS))
        self.assertLessEqual({"distributed", "distributed_extrapolated"}, set(page.TABLE_TITLES))
        self.assertIn("distributed", page.FIGURE_TITLES)

    def test_they_appear_nowhere_without_rows(self):
        made = outcome.make(frame_of([synthetic.row()]))
        self.assertFalse({"distributed", "distributed_extrapolated"} & {*made.tables, *made.figures})
        self.assertIn("distributed", made.missing)
        self.assertTrue(isinstance(distributed.readable(table_of([row(1)])), pandas.DataFrame))


if __name__ == "__main__":
    unittest.main()
