"""What our records say about the paper: a verdict for each claim, and for each cell of Tables 1 and 2.

Machines differ, so only shapes are judged. `agrees` and `differs` are within and beyond the tolerance, on either side:
a decline of the paper's that is absent here differs. What is measured and varies is `not_resolved` where its interval
straddles the tolerance or has too few rounds for 95 %, as in podm-bench verdicts. `reference` is no finding but what
others refer to; `cannot_fill` says why there is none of ours.
"""
from . import cells, claims

SCHEMA = "podm-figures/3"


def verdicts(frame, series, hops):
    """`hops`: the table of table2(). Measured and simulated are judged apart."""
    return {"schema": SCHEMA, "claims": claims.claims(frame, series, hops), "cells": cells.cells(frame, series, hops)}
