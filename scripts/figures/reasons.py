"""Gives the reason why a value of ours is missing."""
import pandas

from . import table2


def why_missing(frame, series, basis, algorithm, cores, needs_hops=False):
    """The reason may be the machine, the lack of a run, or runs that did not verify."""
    wanted = frame
    for column, value in (("basis", basis), ("algorithm", algorithm), ("cores", cores)):
        wanted = wanted[wanted[column] == value] if column in wanted else wanted.iloc[:0]
    if len(wanted):
        doubts = sorted(set(wanted.loc[~wanted["headline"], "doubt"]))
        if doubts and not wanted["headline"].any():
            return "no row to count: " + doubts[0]
        if needs_hops:
            return table2.why_no_hops(wanted)
        if series is None:
            return "no row of PODM on one core of this input, program and machine to refer to"
        return f"rows are of another series than {series.label()}"
    return lack_of_cores(frame, basis, cores) or f"no {basis} row of {algorithm} with {cores} cores"


def lack_of_cores(frame, basis, cores):
    """Returns "needs 32 cores, has 2" if no machine of the rows has enough cores, otherwise an empty text. Simulations
    do not need the cores."""
    usable = frame["usable_cores"].dropna() if "usable_cores" in frame else pandas.Series(dtype=float)
    if basis != "measured" or usable.empty or usable.max() >= cores:
        return ""
    return f"needs {cores} cores, has {int(usable.max())}"


def of_basis(frame, basis):
    return frame[frame["basis"] == basis] if len(frame) else frame
