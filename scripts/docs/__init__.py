"""Recomputes each figure of the documentation from the rows that its query names (see README.md in this folder)."""
