"""Figures of the documentation: each is recomputed from the rows that its query names (README.md here)."""
