"""Reads meshes from files, measures their cells, and draws them as a picture."""
