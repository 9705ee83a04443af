"""Checks that a row may give a figure: committed sources must have made its programs, and if the value depends on the
machine, all rows must come from one known machine."""
import re
from functools import lru_cache

from .errors import DocsError

# Properties of a mesh or of a simulated machine are equal on every machine. All other values depend on the machine.
FACTS = {"cells", "vertices", "boundary_facets", "labels", "facet_pairs", "quality", "dihedral_deg", "counters",
         "outcomes", "guarantees", "verdicts", "status", "replay", "mesh_sha256", "perturbed", "optimization",
         "smoothing", "promised_dihedral_deg", "used", "asked", "options", "resolved", "repeat", "trial", "input",
         "image", "leaves", "threads", "cores", "mesh_bytes", "algorithm", "mesher", "lines", "line_distances",
         "thin_layers", "facets_of_sides", "box_ulps_off", "interface_distance_mm", "topology"}
# Such values in files that hold no rows of trials: random runs, plans beside runs, angles.
FACTS_ELSEWHERE = {"cells", "planned_cells", "components", "lost", "cut", "missed", "lost_not_said_whole",
                   "cut_by_details", "at_lines", "away", "ratio_of_means", "runs", "counts", "failed_seeds",
                   "first_seed", "last_seed"}
FACTS_OF_RANKS = re.compile(r"on_ranks\.(number|threads|asked_cells|cells_per_rank|rounds|deferred_share|imbalance"
                            r"|cells_over_one_machine|store_cells_per_cell|learnt_per_vertex)\b"
                            r"|ranks\.(number|rounds\[\d+\]\.(deferred|entries|insertions)|imbalance)\b")
FACTS_OF_SOLVERS = re.compile(r"solve\.\w+\.(unknowns|\w+\.(iterations|smallest_eigenvalue|largest_eigenvalue))\b")
# For workers in virtual time these are virtual seconds and counts, which do not depend on the machine either. Virtual
# threads of ranks are different: their seconds are processor seconds of the machine, divided by a simulated schedule.
OF_VIRTUAL_TIME = {"virtual", "seconds", "whole_s", "refining_s", "timed", "overhead_s", "hops", "hops_by_kind",
                   "workers"}
IDENTITY = ("CPUVendor", "CPUFamilyNumber", "CPUModelNumber", "CPUStepping")


class Provenance:
    """Judges rows of the files of `sources`."""

    def __init__(self, sources):
        self._sources = sources
        self._identity_of = lru_cache(maxsize=None)(self._read_identity)

    def fault_of(self, rows, expression):
        """Returns the reason why `rows` may not give a value of `expression`; empty if they may."""
        for row in rows:
            if dirty := dirty_programs(row):
                return f"row {key_of(row)} is of {' and '.join(dirty)} with sources that were not committed"
        machines = {}
        for row in rows:
            if depends_on_machine(row, expression):
                machine = self.machine_of(row)
                if machine is None:
                    return f"row {key_of(row)} names no machine, or one whose topology is in no file"
                machines.setdefault(machine, row)
        if len(machines) > 1:
            return "rows of two machines: " + " and ".join(f"{key_of(row)} ({' '.join(map(str, machine))})"
                                                           for machine, row in list(machines.items())[:2])
        return ""

    def machine_of(self, row):
        """Returns what identifies a machine: the processor by CPUID, and its caches; None if the row names no
        machine."""
        environment = row.get("environment") or {}
        identity = environment.get("identity")
        if isinstance(identity, dict):
            known = [identity.get(name) for name in ("vendor", "family", "model", "stepping")]
            caches = identity.get("cache_bytes")
            return None if None in known else (*map(str, known), _text(caches if isinstance(caches, dict) else {}))
        return self._identity_of(environment.get("topology_sha256"))

    def _read_identity(self, topology):
        path = next(self._sources.reference.rglob(f"topology-{topology}.xml"), None) if topology else None
        if path is None:
            return None
        text = path.read_text()
        info = dict(re.findall(r'<info name="(CPU\w+)" value="([^"]*)"', text))
        if not set(IDENTITY) <= set(info):
            raise DocsError(f"{path.relative_to(self._sources.root)}: has no {', '.join(IDENTITY)}")
        caches = re.findall(r'<object type="(L\d)Cache"[^>]* cache_size="(\d+)"', text)
        return (*(info[name] for name in IDENTITY), _text(dict(caches)))


def _text(caches):
    """Returns the data caches by level."""
    return " ".join(f"{level}:{size}" for level, size in sorted(caches.items()))


def depends_on_machine(row, expression):
    rest = FACTS_OF_RANKS.sub("0", FACTS_OF_SOLVERS.sub("0", expression.text))
    roots = {name for name in expression.roots if re.search(rf"(?<![\w.]){name}\b", rest)} - FACTS
    if "environment" not in row:
        roots -= FACTS_ELSEWHERE
    has_costs_of_model = row.get("executor") == "virtual" and not row.get("ranks")
    return bool(roots - OF_VIRTUAL_TIME if has_costs_of_model else roots)


def dirty_programs(row):
    """Returns the names of the programs that made the row from sources with uncommitted changes."""
    programs = {name: program.get("build") or {} for name, program in (row.get("programs") or {}).items()
                if isinstance(program, dict)}  # "none": the meshes were not verified
    sources = (row.get("environment") or {}).get("sources")
    programs["podm-bench"] = sources if isinstance(sources, dict) else {}
    dirty = [name for name, build in programs.items() if str(build.get("dirty")).lower() == "true"]
    if "dirty: true" in (row.get("program") if isinstance(row.get("program"), list) else []):
        dirty.append("podm")
    return dirty


def key_of(row):
    return row.get("key", "without a key")[:12]
