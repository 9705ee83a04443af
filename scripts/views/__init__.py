"""Meshes to look at: read from files, measured by cell, drawn as a picture."""
