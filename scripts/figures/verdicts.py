"""Compares our records with the paper: a verdict for each claim, and for each cell of Tables 1 and 2.

Machines differ, therefore only shapes are judged. `agrees` is within the tolerance and `differs` beyond it, on either
side: a decline in the paper that is absent here differs. A measured value that varies is `not_resolved` if its interval
straddles the tolerance or has too few rounds for 95 %, as in podm-bench verdicts. `reference` marks a value to which
other values refer; `cannot_fill` gives the reason why we have no value.
"""
from . import cells, claims

SCHEMA = "podm-figures/3"


def verdicts(frame, series, hops):
    """`hops`: the table of table2(). Measured and simulated rows are judged separately."""
    return {"schema": SCHEMA, "claims": claims.claims(frame, series, hops), "cells": cells.cells(frame, series, hops)}
