"""The machine on which a row was measured: its name, and whether it was quiet and steady meanwhile. Decides as
harness/rows/machine_state.h does."""
import hashlib
import json

TOLERATED_LOAD = 0.1  # share of each usable processor that other work may keep busy
MACHINE = ("cpu", "packages", "numa_nodes", "cores", "processors", "usable_processors", "identity")
MOVED = "the machine's speed moved during the round"


def name_of(environment):
    """Returns the same name for rows of the same machine, and different names for different machines. Rows without an
    identity are also distinguished by their topology, which has the processor's model."""
    cpu, identity = environment.get("cpu", "unknown machine"), environment.get("identity")
    if not identity:
        topology = environment.get("topology_sha256", "")
        return f"{cpu} (topology {topology[:8]})" if topology else cpu
    facts = json.dumps({key: environment.get(key) for key in MACHINE}, sort_keys=True)
    return (f"{cpu}, family {identity['family']} model {identity['model']} stepping {identity['stepping']} "
            f"({hashlib.sha256(facts.encode()).hexdigest()[:8]})")


def has_moved(row):
    return row.get("probe_moved") is True


def is_disturbed(row):
    """False for simulated rows and if the load is unknown."""
    environment = row.get("environment", {})
    busy = environment.get("busy_elsewhere")
    return (row.get("basis") == "measured" and isinstance(busy, (int, float))
            and busy > TOLERATED_LOAD * environment.get("usable_processors", 1))


def remarks(frame):
    """Returns sentences on the measured rows of a frame of load.py; none if their machine was quiet and steady."""
    if frame.empty:
        return []
    measured = frame[frame["basis"] == "measured"]
    disturbed, moved = measured[measured["disturbed"]], int(measured["moved"].sum())
    remarks = []
    if len(disturbed):
        busy = disturbed["environment.busy_elsewhere"].astype(float).mean()
        processors = int(disturbed["environment.usable_processors"].iloc[-1])
        remarks.append(f"Other work kept {busy:.1f} of {processors} processors busy during {len(disturbed)} of "
                       f"{len(measured)} runs: measured claims are not resolved.")
    if moved:
        remarks.append(f"The machine's speed moved during the rounds of {moved} of {len(measured)} runs: their times "
                       "do not count.")
    return remarks
