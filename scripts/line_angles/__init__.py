"""Angle errors of a mesh's facets along lines where three labels meet."""
