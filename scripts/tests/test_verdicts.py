"""Tests verdicts: the paper's own tables agree with themselves, their mirrors do not, and missing rows give no
verdict."""
import unittest

import paths  # noqa: F401
import synthetic
from figures import cells, claims, paper, resolution, scaling, table2, verdicts
from test_figures import frame_of

ROUNDS = 6  # the fewest rounds that resolve measured values
POWERS_OF_TWO = (1, 16, 32, 64, 128, 256)
CYCLES = [4, 11, 40, 200, 1500]
CLAIMS = ["crossover", "efficiency of podm", "efficiency of pdr-podm", "speed-up of podm beyond 128 cores",
          "speed-up of pdr-podm beyond 128 cores", "zero-hop share", "latency within a node", "latency beyond a node",
          "deviation of podm", "deviation of pdr-podm", "zero-hop share by number of cores"]


def judged(rows):
    frame = frame_of(rows)
    return verdicts.verdicts(frame, scaling.weak_series(frame), table2.table2(frame))


def cell_of(found, **where):
    (cell,) = [one for one in found["cells"] if all(one[key] == value for key, value in where.items())]
    return cell


def claim_of(found, name, basis="measured"):
    (claim,) = [one for one in found["claims"] if one["claim"] == name and one["basis"] == basis]
    return claim


def fed(weak, shares, cycles, **changes):
    """Returns verdicts on the given tables as if they were ours; Tables 1 and 2 may be of either basis."""
    rows = synthetic.like_the_paper(weak, repeats=ROUNDS, spread=0.005, **changes)
    wide = {cores: list(shares[cores]) for cores in shares}
    extra = [synthetic.row("pdr-podm", 16, repeat=repeat, environment=synthetic.BIG_MACHINE, **changes)
             for repeat in range(1, ROUNDS + 1)]  # Table 1 has no 16 cores
    return judged([*synthetic.with_hops([*rows, *extra], wide), *levels(cycles)])


def levels(cycles):
    return [synthetic.with_levels(cycles) for _ in range(ROUNDS)]


def swapped(weak):
    """Exchanges the numbers of PODM and PDR.PODM."""
    other = dict(zip(paper.ALGORITHMS, reversed(paper.ALGORITHMS)))
    made = weak.copy()
    made.index = made.index.map(lambda index: (other[index[0]], index[1]))
    return made


def with_speedups(weak, speedup_of):
    """Sets the seconds beyond one core to those that `speedup_of` (cores, speed-ups) of an algorithm gives."""
    made = weak.copy()
    base = made.loc[("podm", 1), "cells"] / made.loc[("podm", 1), "seconds"]
    for algorithm in paper.ALGORITHMS:
        part = made.loc[algorithm].drop(index=1)
        for cores, speedup in zip(part.index, speedup_of(part.index, part["speedup"])):
            made.loc[(algorithm, cores), "seconds"] = part.loc[cores, "cells"] / base / speedup
    return made


def efficiencies_reversed(weak):
    """Puts the efficiency of the most cores on the fewest, so that declines become rises."""
    return with_speedups(weak, lambda cores, speedups: (speedups / cores)[::-1].to_numpy() * cores)


def speedups_turned(weak):
    """Turns falls from 128 cores on into rises, and rises into falls."""
    return with_speedups(weak, lambda cores, speedups: speedups[128] ** 2 / speedups)


def times(weak, factor, but=("podm", 1)):
    """Multiplies all seconds by a factor, except those to which ratios refer."""
    made = weak.copy()
    made.loc[[index for index in made.index if index != but], "seconds"] *= factor
    return made


def of_basis(found, basis):
    """Returns the verdicts on one basis, and Table 3's, which are only measured."""
    return [one for one in found if one["basis"] == basis or "latency" in one.get("claim", "")]


class Published(unittest.TestCase):
    """Judges Tables 1 to 3 of the paper as if they were ours."""

    def feeds(self):
        """Yields (Table 1, Table 2, basis, changes of its rows), for all numbers of cores and for powers of two
        only."""
        for counts in (None, POWERS_OF_TWO):
            for basis, changes in (("measured", {}), ("simulated", {"executor": "virtual"})):
                weak, shares = paper.corrected_table1(), paper.table2()
                if counts:
                    weak = weak[weak.index.get_level_values("cores").isin(counts)]
                    shares = shares[[cores for cores in shares if cores in counts]]
                yield weak, shares, basis, changes

    def test_all_claims_and_cells_agree(self):
        for weak, shares, basis, changes in self.feeds():
            with self.subTest(counts=list(shares), basis=basis):
                found = fed(weak, shares, CYCLES, **changes)
                own = of_basis(found["claims"], basis)
                expected = dict.fromkeys(CLAIMS, "agrees")
                if len(shares.columns) < len(paper.table2().columns):  # it is on every number of cores
                    expected["zero-hop share by number of cores"] = "cannot_fill"
                self.assertEqual({one["claim"]: one["verdict"] for one in own}, expected)
                here = {("1", cores) for cores in weak.index.get_level_values("cores")} | {("2", one) for one in shares}
                for cell in of_basis(found["cells"], basis):
                    if (cell["table"], cell["cores"]) not in here:
                        expected = "cannot_fill"
                    else:
                        is_base = cell["column"] == "cells" or (cell["algorithm"], cell["cores"]) == ("podm", 1)
                        expected = "reference" if is_base else "agrees"
                    self.assertEqual(cell["verdict"], expected, cell)

    def check_mirrored(self, weak, shares, cycles, names):
        """Checks that all claims named differ on mirrored tables, judged as ours; yields the cells of each feed."""
        for their_weak, their_shares, basis, changes in self.feeds():
            with self.subTest(counts=list(their_shares), basis=basis):
                found = fed(weak(their_weak), shares(their_shares), cycles, **changes)
                own = {one["claim"]: one["verdict"] for one in of_basis(found["claims"], basis)}
                self.assertEqual({name: own[name] for name in names}, dict.fromkeys(names, "differs"))
            yield [one for one in of_basis(found["cells"], basis) if one["n"]]

    def test_nothing_agrees_with_algorithms_swapped_and_shares_mirrored(self):
        for found in self.check_mirrored(swapped, lambda shares: 1 - shares, CYCLES[::-1], CLAIMS):
            # Up to 128 cores the two algorithms are alike.
            apart = [one for one in found if one["table"] == "1" and one["cores"] >= 160 and one["column"] != "cells"]
            self.assertEqual({one["verdict"] for one in apart}, {"differs"})
            of_table2 = [one for one in found if one["table"] == "2"]
            self.assertEqual({one["verdict"] for one in of_table2}, {"differs"})

    def test_no_trend_agrees_when_reversed(self):
        for weak, names in ((efficiencies_reversed, CLAIMS[:3]), (speedups_turned, CLAIMS[3:5])):
            for found in self.check_mirrored(weak, lambda shares: shares.iloc[::-1].set_axis(shares.index), CYCLES,
                                             [*names, "zero-hop share"]):
                ends = [one for one in found if one["table"] == "1" and one["cores"] == 256]
                self.assertEqual({one["verdict"] for one in ends if one["column"] == "efficiency"}, {"differs"})

    def test_each_cell_of_table_1_can_fail(self):
        for factor in (0.5, 2):
            found = fed(times(paper.corrected_table1(), factor), paper.table2(), CYCLES)
            own = [one for one in found["cells"] if one["table"] == "1" and one["basis"] == "measured"
                   and one["verdict"] != "reference"]
            self.assertEqual(len(own), 15 * 4)
            self.assertEqual({one["verdict"] for one in own}, {"differs"})

    def test_each_cell_of_table_2_can_fail(self):
        """A difference of half a percent must count: the shares that leave their node are multiplied by three."""
        remote = paper.table2().drop(index=0) * 3 + 5e-4
        shares = remote.copy()
        shares.loc[0] = 1 - remote.sum()
        found = fed(paper.corrected_table1(), shares.sort_index(), CYCLES)
        own = [one for one in found["cells"] if one["table"] == "2" and one["basis"] == "measured"]
        self.assertEqual(len(own), 8 * 5)
        self.assertEqual({one["verdict"] for one in own}, {"differs"})
        self.assertEqual(claim_of(found, "zero-hop share")["verdict"], "differs")


class Crossover(unittest.TestCase):
    def claim(self, counts, ahead_from):
        """Judges rows on those numbers of cores, where PDR.PODM is ahead from one of them on."""
        rows = [synthetic.row(algorithm, cores, repeat=repeat, environment=synthetic.BIG_MACHINE,
                              phases_s={"refine": 9.0 if ahead else 10.0})
                for repeat in range(1, ROUNDS + 1) for cores in counts for algorithm in paper.ALGORITHMS
                for ahead in [(algorithm == "pdr-podm") == (cores >= ahead_from)]]
        return claim_of(judged(rows), "crossover")

    def test_of_the_paper(self):
        self.assertEqual(claims.crossover(paper.table1()), (128, 160))
        self.assertEqual(claims.crossover(paper.table1().query("cores <= 128")), (128, None))

    def test_a_bracket_decides_when_it_lies_apart_or_holds_the_papers_closely(self):
        for counts, ahead_from, verdict in (
            ((1, 64, 128, 160, 256), 160, "agrees"),
            ((1, 128, 256), 256, "agrees"),
            ((1, 128, 144, 256), 144, "agrees"),
            ((1, 64, 128, 256), 128, "differs"),
            ((1, 128, 192, 256), 256, "differs"),
            ((1, 64, 160), 1, "differs"),
            ((1, 64, 256), 512, "differs"),
            ((1, 16, 256), 256, "cannot_fill"),
            ((1, 64, 128), 128, "cannot_fill"),
            ((160, 256), 160, "cannot_fill"),
        ):
            with self.subTest(counts=counts, ahead_from=ahead_from):
                claim = self.claim(counts, ahead_from)
                self.assertEqual(claim["verdict"], verdict, claim)
                self.assertTrue(claim["reason"])


class Missing(unittest.TestCase):
    def test_every_cell_and_claim_has_a_value_or_a_reason(self):
        for rows in ([], [synthetic.row()], [synthetic.row("pdr-podm")]):
            found = judged(rows)
            self.assertEqual(len(found["cells"]), 2 * (2 * 8 * 5 + 8 * 5))
            for cell in found["cells"]:
                self.assertTrue(cell["reason"] if cell["value"] is None else cell["n"], cell)
            for claim in found["claims"]:
                self.assertEqual(claim["verdict"], "cannot_fill")
                self.assertTrue(claim["reason"], claim)

    def test_a_small_machine_is_the_reason(self):
        found = judged([synthetic.row(), synthetic.row(cores=2)])
        cell = cell_of(found, table="1", basis="measured", algorithm="podm", cores=32, column="speedup")
        self.assertEqual((cell["verdict"], cell["reason"]), ("cannot_fill", "needs 32 cores, has 2"))
        self.assertEqual(claim_of(found, "crossover")["reason"], "needs 160 cores, has 2")
        cell = cell_of(found, table="1", basis="simulated", algorithm="podm", cores=32, column="speedup")
        self.assertEqual(cell["reason"], "no simulated row of podm with 32 cores")

    def test_a_mesh_that_did_not_verify_is_the_reason(self):
        rows = [synthetic.row(verdicts={**synthetic.PASSED, "size": "fail"})]
        cell = cell_of(judged(rows), table="1", basis="measured", algorithm="podm", cores=1, column="rate")
        self.assertEqual(cell["reason"], "no row to count: claim size failed")

    def test_one_node_decides_nothing_about_hops_and_latency_beyond(self):
        rows = [*synthetic.with_hops([synthetic.row("pdr-podm", 16, executor="virtual")], {16: [1, 0, 0]}),
                *levels(CYCLES[:4])]
        found = judged(rows)
        self.assertEqual(claim_of(found, "zero-hop share", "simulated")["verdict"], "cannot_fill")
        self.assertEqual(claim_of(found, "latency within a node")["verdict"], "agrees")
        beyond = claim_of(found, "latency beyond a node")
        self.assertEqual((beyond["verdict"], beyond["reason"]), ("cannot_fill", "one NUMA node"))

    def test_a_decline_that_is_absent_differs(self):
        level = paper.corrected_table1()
        level["seconds"] = level["cells"] / 1.1e5 / level.index.get_level_values("cores")
        found = fed(level, paper.table2(), CYCLES)
        for name in ("efficiency of podm", "efficiency of pdr-podm", "speed-up of podm beyond 128 cores"):
            self.assertEqual(claim_of(found, name)["verdict"], "differs")
        self.assertEqual(cell_of(found, table="1", basis="measured", algorithm="podm", cores=256,
                                 column="rate")["verdict"], "differs")

    def test_shares_agree_within_a_factor_or_a_digit(self):
        for ours, published, agrees in ((0.0055, 0.0049, True), (0.0001, 0.0, True), (0.0, 0.0049, False),
                                        (0.0102, 0.0049, False)):
            least, most = cells.near_share(published)
            self.assertEqual(least <= ours <= most, agrees)


class NotResolved(unittest.TestCase):
    """Values measured in few rounds, or on both sides of a bound, neither agree nor differ."""

    def test_nothing_measured_is_decided_by_three_rounds(self):
        rows = synthetic.like_the_paper(paper.corrected_table1(), repeats=3, spread=0.005)
        shares = {cores: list(paper.table2()[cores]) for cores in paper.table2()}
        found = judged([*synthetic.with_hops(rows, shares), synthetic.with_levels(CYCLES)])
        own = [one for part in ("claims", "cells") for one in found[part]
               if one["basis"] == "measured" and one["verdict"] not in ("reference", "cannot_fill")]
        self.assertEqual({one["verdict"] for one in own}, {"not_resolved"})
        self.assertTrue(all("too few rounds" in one["reason"] or "is not resolved" in one["reason"] for one in own))

    def test_virtual_time_needs_one_round(self):
        rows = synthetic.like_the_paper(paper.corrected_table1(), repeats=1, spread=0, executor="virtual")
        found = judged(rows)
        self.assertEqual(claim_of(found, "crossover", "simulated")["verdict"], "agrees")

    def test_rounds_on_both_sides_of_the_tolerance_resolve_nothing(self):
        rows = synthetic.like_the_paper(times(paper.corrected_table1(), 1.15), repeats=ROUNDS, spread=0.1)
        cell = cell_of(judged(rows), table="1", basis="measured", algorithm="podm", cores=64, column="speedup")
        self.assertEqual(cell["verdict"], "not_resolved")
        self.assertIn("straddles the bound", cell["reason"])

    def test_three_values(self):
        within, beyond, both = ((1.0, 1.1), (2.0, 2.1), (1.0, 2.1))
        for (low, high), word in ((within, "agrees"), (beyond, "differs"), (both, "not_resolved")):
            self.assertEqual(resolution.verdict(1.05, resolution.Interval(low, high, 0.96), 0.9, 1.5), word)
            self.assertEqual(resolution.verdict(1.05, resolution.Interval(low, high, 0.94), 0.9, 1.5), "not_resolved")
        self.assertEqual(resolution.verdict(1.05, resolution.EXACT, 0.9, 1.5), "agrees")
        self.assertEqual(resolution.together(["agrees", "not_resolved", "differs"]), "differs")
        self.assertEqual(resolution.together(["agrees", "not_resolved"]), "not_resolved")


if __name__ == "__main__":
    unittest.main()
