"""Tests the tables that scripts/update_docs generates, from synthetic rows."""
import json
import shutil
import tempfile
import unittest
from pathlib import Path

import paths  # noqa: F401
import synthetic
from docs.errors import DocsError
from docs.provenance import Provenance
from docs.sources import Sources
from docs.tables import generate
from test_audit import TOPOLOGY, environment


class Tables(unittest.TestCase):
    def setUp(self):
        self.root = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.root)
        self.folder = self.root / "results/reference/0.1.0/what"
        self.folder.mkdir(parents=True)
        for topology, model in ("aaaa", 207), ("bbbb", 143):
            (self.folder / f"topology-{topology}.xml").write_text(TOPOLOGY.format(model=model))

    def lines(self, name, rows, argument="0.1.0/what"):
        """Returns the cells of the table of `rows`, a list for each line below the head."""
        (self.folder / "rows.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        sources = Sources(self.root)
        made = generate(name, [argument], sources, Provenance(sources)).splitlines()
        return [[cell.strip() for cell in line.strip("|").split("|")] for line in made if not line.startswith("| ---")]

    def test_speedups_are_those_of_each_size_beside_the_papers(self):
        rows = [row for size in (40_000, 160_000)
                for row in synthetic.simulated_size(size, lambda algorithm, cores, size=size: cores * size / 320_000)]
        head, at_32, at_256 = self.lines("simulated_speedups", rows)
        self.assertEqual(at_256[0], "256")
        found = dict(zip(head, at_256))
        self.assertEqual((found["PODM: paper"], found["PDR.PODM: paper"]), ("44.7", "163.8"))
        self.assertEqual(self.of_size(head, at_256, "PODM", "40"), "32.0")
        self.assertEqual(self.of_size(head, at_256, "PODM", "160"), "128.0")
        self.assertEqual(self.of_size(head, at_32, "PDR.PODM", "40"), "4.0")

    def of_size(self, head, line, algorithm, size):
        size = f": {size}\N{NO-BREAK SPACE}k"
        return next(cell for title, cell in zip(head, line)
                    if title.split(":")[0].split(",")[0] == algorithm and title.endswith(size))

    def test_sharing_has_a_line_for_each_cost_with_its_own_base(self):
        rows = [synthetic.row(algorithm, cores, executor="virtual", cells=1_000_000, phases_s={"refine": seconds},
                              asked={"cost_factor": factor} if factor else {})
                for factor, slower in ((None, 1), ("page_fault=4", 4), ("line_transfer=0.5", 2), ("line_transfer=8", 3))
                for algorithm, cores, seconds in (("podm", 1, 100), ("podm", 256, 2 * slower),
                                                  ("podm-home", 256, slower))]
        head, *lines = self.lines("sharing", rows, "0.1.0/what/rows.jsonl")
        self.assertEqual(head, ["cost", "PODM", "PDR.PODM", "PODM at home"])
        self.assertEqual(lines, [["none", "50.0", "not simulated", "100.0"],
                                 ["a line in 50 ns", "25.0", "not simulated", "50.0"],
                                 ["a line in 800 ns", "16.7", "not simulated", "33.3"],
                                 ["a page in 4 us", "12.5", "not simulated", "25.0"]])

    def slivers(self, topology="aaaa"):
        for threads, seconds in (1, 3.0), (2, 2.0):
            for repeat in (1, 2, 3):
                yield synthetic.row(cores=threads, cells=1_200_000, repeat=repeat, environment=environment(topology),
                                    trial=f"1M-both,input=x,threads={threads}",
                                    phases_s={"refine": 9.0, "perturb": seconds - 1, "optimize": 1.0},
                                    quality={"min_dihedral_deg": 8 + repeat, "max_dihedral_deg": 160 + threads})

    def test_slivers_are_listed_by_image_with_the_gain_of_two_threads(self):
        head, line = self.lines("slivers", list(self.slivers()))
        found = dict(zip(head, line))
        self.assertEqual((found["M cells/s, one thread"], found["gain on two threads"]), ("0.40", "1.50"))
        self.assertEqual((found["least angle"], found["largest angle"], found["rows"]), ("9.00", "162.00", "6"))

    def test_seconds_of_two_machines_or_of_none_give_no_table(self):
        for topology in ("bbbb", "gone"):
            rows = [*self.slivers(), *self.slivers(topology)]
            with self.assertRaises(DocsError):
                self.lines("slivers", rows)

    def test_costs_add_up_what_rows_took(self):
        rows = [synthetic.row(environment=environment("aaaa"), preparation_s=20.0, verification_s=10.0,
                              process={"wall_s": 60.0, "peak_rss_bytes": peak * 2**20}) for peak in (5, 7)]
        self.assertEqual(self.lines("costs", rows)[1], ["weak", "2", "3.0", "2.0", "7"])

    def test_answers_of_the_gate_are_counts_of_tries(self):
        row = {"basis": "simulated", "noise_percent": 4.5, "planted_percent": 5, "tries": 30, "slower": 28,
               "not_slower": 0, "not_resolved": 2, "median_rounds": 50.0}
        self.assertEqual(self.lines("gate", [row], "0.1.0/what/rows.jsonl")[1],
                         ["4.5 %", "5 %", "28 of 30", "0 of 30", "2 of 30", "50"])

    def test_machines_are_named_by_their_processor_or_not_known(self):
        rows = [synthetic.row(environment=environment(topology)) for topology in ("aaaa", "aaaa", "gone")]
        _, known, lost = self.lines("machines", rows)
        self.assertEqual(known[:6], ["aaaa", "what", "GenuineIntel", "6", "207", "2"])
        self.assertEqual(lost[:3], ["gone", "what", "not known"])

    def test_verdicts_are_those_of_the_file(self):
        (self.folder / "verdicts.json").write_text(json.dumps(synthetic.experiment_verdicts(first="holds")))
        sources = Sources(self.root)
        text = generate("verdicts", ["0.1.0/what/verdicts.json"], sources, Provenance(sources))
        self.assertIn("| weak_scaling | first | measured | holds |", text)

    def test_arguments_that_do_not_fit_are_a_fault(self):
        (self.folder / "verdicts.json").write_text("{}")
        for name, arguments in (("costs", []), ("costs", ["0.1.0/gone"]), ("gone", []),
                                ("verdicts", ["0.1.0/what/verdicts.json"])):
            sources = Sources(self.root)
            with self.assertRaises(DocsError):
                generate(name, arguments, sources, Provenance(sources))


if __name__ == "__main__":
    unittest.main()
