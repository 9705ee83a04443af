"""The published values, results/paper/, in the units of our own tables: cells, seconds, cells per second, fractions."""
from pathlib import Path

import pandas

FOLDER = Path(__file__).resolve().parents[2] / "results" / "paper"
ALGORITHMS = ("podm", "pdr-podm")
# results/paper/errata.md, first row: printed 63.8.
CORRECTED = {("podm", 64, "speedup"): 62.8}


def table1():
    """The values as printed, indexed by (algorithm, cores)."""
    wide = pandas.read_csv(FOLDER / "table1.csv")
    parts = []
    for algorithm in ALGORITHMS:
        prefix = algorithm.replace("-", "_") + "_"
        parts.append(pandas.DataFrame({
            "algorithm": algorithm,
            "cores": wide["cores"],
            "cells": wide["elements_millions"] * 1e6,
            "seconds": wide[prefix + "seconds"],
            "rate": wide[prefix + "millions_per_second"] * 1e6,
            "speedup": wide[prefix + "speedup"],
            "efficiency": wide[prefix + "efficiency_percent"] / 100,
        }))
    return pandas.concat(parts).set_index(["algorithm", "cores"])


def corrected_table1():
    """Returns Table 1 with misprints corrected. Our values are compared with it."""
    table = table1()
    for (algorithm, cores, column), value in CORRECTED.items():
        table.loc[(algorithm, cores), column] = value
    return table


def table2():
    """Returns shares of memory accesses, indexed by hops, one column per number of cores (PDR.PODM)."""
    table = pandas.read_csv(FOLDER / "table2.csv", index_col="hops") / 100
    table.columns = table.columns.astype(int)
    return table


def table3():
    """Returns the values as printed, indexed by level. Clock cycles are text, because `O(n)` is an order of
    magnitude."""
    return pandas.read_csv(FOLDER / "table3.csv", index_col="level", dtype={"access_clock_cycles": str})
