"""Tests the machine of rows, and the remarks on a machine that was busy or changed its speed."""
import copy
import unittest

import paths  # noqa: F401
import pandas
import synthetic
from figures import machine_state, outcome, scaling
from figures.load import derived, turn_of

IDENTITY = {"vendor": "AuthenticAMD", "family": 25, "model": 17, "stepping": 1, "memory_gib": 24, "kernel": "Linux 6",
            "cache_bytes": {"L1": 32768, "L2": 1048576, "L3": 33554432}}
OTHERS = {"vendor": "GenuineIntel", "family": 26, "model": 2, "stepping": 0, "memory_gib": 48, "kernel": "Linux 7",
          "cache_bytes": {"L1": 32768, "L2": 1048576, "L3": 16777216}}


def on(identity=None, cores=1, repeat=1, **environment):
    state = synthetic.ROW["environment"] | {"identity": copy.deepcopy(identity) if identity else None} | environment
    return synthetic.row(cores=cores, repeat=repeat, environment=state)


def frame_of(rows):
    return pandas.json_normalize([{**row, **derived(row)} for row in rows], sep=".")


class Identity(unittest.TestCase):
    def test_each_part_of_an_identity_makes_another_machine(self):
        changed = [IDENTITY | {key: value} for key, value in OTHERS.items()]
        names = {machine_state.name_of(on(one)["environment"]) for one in [IDENTITY, *changed]}
        self.assertEqual(len(names), 1 + len(OTHERS))
        self.assertEqual(machine_state.name_of(on(IDENTITY)["environment"]),
                         machine_state.name_of(on(IDENTITY, memory_bytes={"available": 7})["environment"]))

    def test_rows_without_an_identity_are_distinguished_by_their_topology(self):
        names = {machine_state.name_of(on(topology_sha256=one * 64)["environment"]) for one in "ab"}
        self.assertEqual(names, {"Synthetic CPU (topology aaaaaaaa)", "Synthetic CPU (topology bbbbbbbb)"})

    def test_rows_of_two_machines_meet_in_no_ratio(self):
        other = IDENTITY | {"model": 2}
        (series,) = scaling.weak_series(frame_of([on(IDENTITY), on(IDENTITY, cores=2), on(other, cores=2)]))
        self.assertEqual(series.table.loc[("podm", 2), "n"], 1)
        self.assertNotEqual(*(turn_of(one | {"trial": "t"}) for one in (on(IDENTITY), on(other))))

    def test_simulated_rows_are_the_same_wherever_they_were_made(self):
        rows = [one | {"executor": "virtual", "basis": "simulated"} for one in (on(IDENTITY), on(OTHERS))]
        self.assertEqual(len({derived(row)["machine"] for row in rows}), 1)


class State(unittest.TestCase):
    def test_rows_whose_round_the_speed_moved_in_are_in_no_ratio(self):
        rows = [on(cores=cores, repeat=repeat) for repeat in (1, 2) for cores in (1, 2)]
        for row in rows[2:]:
            row.update(probe_moved=True, phases_s={"refine": 1.0 / row["threads"]["used"]})
        made = outcome.make(frame_of(rows))
        self.assertEqual(made.series[0].table.loc[("podm", 2), "n"], 1)
        self.assertAlmostEqual(made.series[0].table.loc[("podm", 2), "refining_efficiency"], 1.0)
        self.assertIn(machine_state.MOVED, set(frame_of(rows)["doubt"]))
        self.assertEqual(made.remarks, ["The machine's speed moved during the rounds of 2 of 4 runs: their times "
                                        "do not count."])

    def test_load_beyond_a_tenth_of_each_processor_is_disturbing(self):
        for busy, expected in ((0.0, False), (0.2, False), (0.21, True), ("unavailable: why", False)):
            self.assertEqual(machine_state.is_disturbed(on(busy_elsewhere=busy)), expected, busy)
        self.assertFalse(machine_state.is_disturbed(on()), "unknown")
        self.assertFalse(machine_state.is_disturbed(on(busy_elsewhere=2.0) | {"basis": "simulated"}))

    def test_one_sentence_says_how_busy_the_machine_was(self):
        rows = [on(busy_elsewhere=busy) for busy in (0.0, 0.7, 0.9, "unavailable: why")]
        self.assertEqual(machine_state.remarks(frame_of(rows)),
                         ["Other work kept 0.8 of 2 processors busy during 2 of 4 runs: measured claims are not "
                          "resolved."])
        self.assertEqual(machine_state.remarks(frame_of([on()])), [])
        self.assertEqual(machine_state.remarks(pandas.DataFrame()), [])


if __name__ == "__main__":
    unittest.main()
