"""Tables and figures of the paper, from records: pure functions from rows to pandas tables and matplotlib figures."""
