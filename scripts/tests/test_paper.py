"""Tests the consistency of the published values, as described in results/paper/errata.md."""
import unittest

import paths  # noqa: F401
from figures import paper


class PublishedValues(unittest.TestCase):
    def setUp(self):
        self.table = paper.corrected_table1()
        base = self.table.loc["podm", 1]
        self.base_rate = base["cells"] / base["seconds"]

    def test_equation_1_gives_the_printed_rates_and_speedups(self):
        for (algorithm, cores), row in self.table.iterrows():
            with self.subTest(algorithm=algorithm, cores=cores):
                rate = row["cells"] / row["seconds"]
                self.assertAlmostEqual(rate / row["rate"], 1, delta=0.025)
                self.assertAlmostEqual(rate / self.base_rate / row["speedup"], 1, delta=0.025)

    def test_efficiency_is_speedup_over_cores(self):
        for (algorithm, cores), row in self.table.iterrows():
            with self.subTest(algorithm=algorithm, cores=cores):
                self.assertAlmostEqual(row["speedup"] / cores / row["efficiency"], 1, delta=0.003)

    def test_only_the_misprint_strays(self):
        printed = paper.table1()
        strayed = abs(printed["speedup"] / printed.index.get_level_values("cores") / printed["efficiency"] - 1) > 0.003
        self.assertEqual(list(printed.index[strayed]), [("podm", 64)])

    def test_elements_per_core_stay_within_three_percent(self):
        per_core = self.table["cells"] / self.table.index.get_level_values("cores")
        self.assertTrue((abs(per_core / 3e6 - 1) < 0.031).all())

    def test_shares_of_table_2_add_up(self):
        self.assertTrue((abs(paper.table2().sum() - 1) < 1.5e-4).all())
        self.assertAlmostEqual(paper.table2().loc[0].min(), 0.9885)

    def test_latency_grows_with_the_level(self):
        cycles = [int(text.strip("O()")) for text in paper.table3()["access_clock_cycles"]]
        self.assertEqual(cycles, sorted(cycles))


if __name__ == "__main__":
    unittest.main()
