"""Tests ranks that share no memory: tables, the extrapolation and figures, from synthetic rows."""
import math
import unittest

import paths  # noqa: F401
import pandas
import synthetic
from figures import distributed, distributed_figure, distributed_model, distributed_strong, outcome, scaling
from report_page import page
from test_figures import frame_of

SIZES = (100_000, 300_000, 1_000_000)


def spent(**seconds):
    """Returns the phases of a rank: computing seconds, or (computing, waiting, network)."""
    every = {phase: one if isinstance(one, tuple) else (one, 0.0, 0.0) for phase, one in seconds.items()}
    return {phase: dict(zip(("computing_s", "waiting_s", "network_s"), one)) for phase, one in every.items()}


def row(ranks, per_rank=100_000, by_rank=None, basis="simulated", cells=None, threads=1, **changes):
    """Returns a row of ranks. By default all ranks spend the same, one microsecond of refining per cell."""
    cells = cells or per_rank * ranks
    even = spent(transform=0.0, refine=1e-6 * per_rank, extract=0.0, measure=5.0)
    told = {"number": ranks, "imbalance": 1.1,
            "rounds": [{"deferred": cells // 50, "update": {"inserted": 0}},
                       {"deferred": 0, "update": {"inserted": cells // 100}}][:ranks],
            "last_update": {"inserted": cells // 100 if ranks > 1 else 0},
            "by_rank": [{"cells": cells // ranks, "store_cells": 3 * cells // (2 * ranks),
                         "seed_vertices": cells // (100 * ranks) if ranks > 1 else 0, "threads": threads,
                         "spent": one} for one in by_rank or [even] * ranks]}
    made = synthetic.row(cores=ranks * threads, cells=cells, vertices=cells // 5, experiment="distributed_weak",
                         trial=f"synthetic,ranks={ranks},threads={threads}",
                         asked={"ranks": ranks, "threads": threads, "target_elements": per_rank * ranks}, ranks=told,
                         resolved={"cells": cells}, process={"bytes_per_cell_beyond_image": 150.0}, **changes)
    return {**made, "basis": basis}


def modelled(ranks, per_rank, volume=1.0, surface=20.0, once=0.0, threads=1):
    """Returns a row of ranks whose refining costs microseconds per cell by volume, later rounds by surface, the
    transform once."""
    x = per_rank ** (-1 / 3)
    phases = {"transform": once, "refine": 1e-6 * per_rank * volume, "extract": 0.0}
    if ranks > 1:
        phases["later"] = 1e-6 * per_rank * surface * x
    return row(ranks, per_rank, [spent(**phases)] * ranks, threads=threads)


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

    def test_waiting_for_seeds_is_waiting(self):
        seeding = spent(initial=(0.02, 0.01, 0.0), refine=(0.1, 0.0, 0.0))
        line = table_of([row(1), row(4, by_rank=[seeding] * 4)]).set_index("ranks").loc[4]
        self.assertAlmostEqual(line["initial"], 0.2)
        self.assertAlmostEqual(line["waiting"], 0.1)

    def test_ranks_are_compared_with_one_rank_of_as_many_threads(self):
        faster = [spent(refine=0.02)] * 2
        table = table_of([row(1), row(1, by_rank=[spent(refine=0.01)], threads=16), row(2, by_rank=faster, threads=16),
                          row(2, by_rank=faster, threads=4)]).set_index(["ranks", "threads"])
        self.assertAlmostEqual(table.loc[(2, 16), "refining_efficiency"], 0.5)
        self.assertTrue(math.isnan(table.loc[(2, 4), "refining_efficiency"]), "no one rank has 4 threads")

    def test_stores_and_learnt_vertices_are_counted_over_all_ranks(self):
        table = table_of([row(1), row(2)]).set_index("ranks")
        self.assertAlmostEqual(table.loc[2, "store_cells_per_cell"], 1.5)
        self.assertAlmostEqual(table.loc[2, "learnt_per_vertex"], 3 / 100 * 5)
        self.assertEqual(table.loc[1, "learnt_per_vertex"], 0)

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
            [modelled(ranks, size, **costs) for size in sizes for ranks in counts])).set_index(["ranks", "threads"])

    def test_costs_of_the_model_are_met_at_20_million(self):
        table = self.extrapolated()
        expected = 1 / (1 + 20 * 2e7 ** (-1 / 3))
        for ranks in (8, 64):
            line = table.loc[ranks, 1]
            for name in ("refining_efficiency", "refining_efficiency_low", "refining_efficiency_high"):
                self.assertAlmostEqual(line[name], expected, places=3)
            self.assertAlmostEqual(line["worst_miss"], 0, places=6)
        self.assertAlmostEqual(table.loc[1, 1]["refining_efficiency"], 1)

    def test_later_rounds_along_edges_vanish_sooner_than_along_faces(self):
        def later(power):
            return distributed_model.extrapolated(table_of(
                [row(ranks, size, [spent(refine=1e-6 * size, later=(ranks > 1) * 1e-6 * size * power(size))] * ranks)
                 for size in SIZES for ranks in (1, 8)])).set_index("ranks").loc[8, "later"]

        self.assertAlmostEqual(later(lambda n: 1e4 * n ** (-2 / 3)), 1e4 * 2e7 ** (-2 / 3), places=4)
        self.assertAlmostEqual(later(lambda n: 1e2 * n ** (-1 / 3)), 1e2 * 2e7 ** (-1 / 3), places=4)

    def test_the_transform_of_one_image_vanishes(self):
        line = self.extrapolated(once=0.5).loc[8, 1]
        self.assertAlmostEqual(line["transform"], 0.5e6 / 2e7, places=4)
        self.assertLess(line["transform"], 0.5e6 / max(SIZES) / 10)

    def test_each_number_of_threads_is_fitted_by_its_own_rows(self):
        rows = [modelled(ranks, size, volume, surface, threads=threads)
                for threads, volume, surface in ((1, 1, 0), (16, 0.1, 20)) for size in SIZES for ranks in (1, 8)]
        table = distributed_model.extrapolated(table_of(rows)).set_index(["ranks", "threads"])
        self.assertAlmostEqual(table.loc[8, 1]["refining_efficiency"], 1, places=3)
        self.assertAlmostEqual(table.loc[8, 16]["refining_efficiency"], 0.1 / (0.1 + 20 * 2e7 ** (-1 / 3)), places=3)
        only_one = distributed_model.extrapolated(table_of(
            [one for one in rows if one["asked"] != {"ranks": 8, "threads": 16, "target_elements": 8 * SIZES[0]}]))
        self.assertEqual(set(map(tuple, only_one[["ranks", "threads"]].to_numpy())), {(1, 1), (8, 1), (1, 16)})

    def test_sizes_on_no_line_have_an_interval_and_a_miss(self):
        rows = [row(1, size) for size in SIZES] + [
            row(8, size, [spent(refine=factor * 1e-6 * size)] * 8) for size, factor in zip(SIZES, (1.2, 1.9, 1.3))]
        line = distributed_model.extrapolated(table_of(rows)).set_index("ranks").loc[8]
        self.assertLess(line["refining_efficiency_low"], line["refining_efficiency"])
        self.assertGreater(line["worst_miss"], 0.1)

    def test_nothing_is_derived_from_two_sizes(self):
        self.assertTrue(self.extrapolated(SIZES[:2]).empty)
        self.assertEqual(set(self.extrapolated()["n"]), {len(SIZES)})
        self.assertEqual(list(self.extrapolated(counts=(1, 2, 4)).index), [(1, 1)])

    def test_one_rank_counts_at_all_its_sizes_and_too_few_cells_at_none(self):
        rows = [modelled(ranks, size) for size in SIZES for ranks in (1, 8)]
        odd = [row(1, 5_000_000, [spent(refine=50.0)]), row(1, 10_000, [spent(refine=9.0)]),
               row(8, 10_000, [spent(refine=9.0)] * 8)]
        plain, with_odd = (distributed_model.extrapolated(table_of(some)).set_index("ranks").loc[8]
                           for some in (rows, [*rows, *odd]))
        self.assertEqual(plain["sizes"], with_odd["sizes"])
        self.assertGreater(with_odd["refining_efficiency"], 2 * plain["refining_efficiency"])

    def test_nothing_measured_is_extrapolated(self):
        rows = [row(ranks, size, basis="measured") for size in SIZES for ranks in (1, 8)]
        self.assertTrue(distributed_model.extrapolated(table_of(rows)).empty)


class Strong(unittest.TestCase):
    def test_speedup_is_over_one_rank_that_makes_as_many_cells(self):
        rows = [row(1, 800_000), row(2, 400_000, [spent(refine=0.5)] * 2), row(8, 100_000, threads=4),
                row(4, 100_000)]
        table = distributed_strong.strong(frame_of(rows)).set_index("ranks")
        self.assertEqual(list(table.index), [1, 2])
        self.assertAlmostEqual(table.loc[2, "refining_speedup"], 0.8 / 0.5)
        self.assertAlmostEqual(table.loc[2, "refining_efficiency"], 0.8)
        self.assertEqual(len(distributed_strong.readable(table.reset_index())), 2)

    def test_measured_ranks_and_one_rank_alone_have_no_line(self):
        measured = [row(1, 800_000, basis="measured"), row(2, 400_000, basis="measured")]
        self.assertTrue(distributed_strong.strong(frame_of([*measured, row(1)])).empty)


class Shown(unittest.TestCase):
    def made(self):
        rows = [modelled(ranks, size, threads=threads)
                for size in SIZES for ranks in (1, 8, 64) for threads in (1, 16)]
        return outcome.make(frame_of([*rows, row(512, threads=16),
                                      *(row(ranks, basis="measured") for ranks in (1, 2, 4))]))

    def test_bases_stay_apart_in_tables_and_figure(self):
        made = self.made()
        shown = made.tables["distributed"][1]
        self.assertEqual({one.split(",")[0] for one in shown["basis"]}, {"simulated", "measured processor seconds"})
        self.assertEqual(len(made.tables["distributed_extrapolated"][1]), 3 * 2)
        *_, simulated, measured = made.figures["distributed"].axes
        legends = [" ".join(text.get_text() for text in axes.get_legend().get_texts())
                   for axes in (simulated, measured)]
        self.assertIn("extrapolated", legends[0])
        self.assertNotIn("extrapolated", legends[1])
        self.assertIn("measured", measured.get_title())
        label = made.figures["distributed"].get_label()
        for words in ("Simulated", "Measured", "no confidence interval", "It is assumed"):
            self.assertIn(words, label)

    def test_there_is_a_panel_for_each_basis_and_number_of_threads_that_has_rows(self):
        table, nodes = self.made().tables["distributed"][0], self.made().tables["distributed_extrapolated"][0]
        for rows, panels in ((table, 5), (table[table["basis"] == "simulated"], 4),
                             (table[table["threads"] == 16], 2), (table[table["basis"] == "measured"], 1)):
            self.assertEqual(len(distributed_figure.figure(rows, nodes).axes), panels)

    def test_parts_are_of_the_size_on_most_ranks(self):
        table, nodes = self.made().tables["distributed"][0], self.made().tables["distributed_extrapolated"][0]
        lines = distributed_figure.most_ranks(table[table["threads"] == 16])
        self.assertEqual(list(lines["ranks"]), [1, 8, 64, 512])
        parts = distributed_figure.figure(table, nodes).axes[1]
        self.assertEqual([tick.get_text() for tick in parts.get_xticklabels()], ["1", "8", "64", "512", "1", "8", "64"])
        tops = [max(bar.get_y() + bar.get_height() for bar in bars) for bars in zip(*parts.containers)]
        shown = nodes[nodes["threads"] == 16]
        for top, line in zip(tops, [*lines.to_dict("records"), *shown.to_dict("records")]):
            self.assertAlmostEqual(top, sum(line[part] for part in distributed.PARTS))

    def test_each_part_has_a_model_words_and_a_colour(self):
        for names in (distributed_model.MODEL, distributed_figure.COLOURS):
            self.assertEqual(set(names), set(distributed.PARTS))
        self.assertLessEqual({"distributed", "distributed_extrapolated", "distributed_strong"}, set(page.TABLE_TITLES))
        self.assertIn("distributed", page.FIGURE_TITLES)

    def test_they_appear_nowhere_without_rows(self):
        made = outcome.make(frame_of([synthetic.row()]))
        names = {"distributed", "distributed_extrapolated", "distributed_strong"}
        self.assertFalse(names & {*made.tables, *made.figures})
        self.assertIn("distributed", made.missing)
        self.assertTrue(isinstance(distributed.readable(table_of([row(1)])), pandas.DataFrame))


if __name__ == "__main__":
    unittest.main()
