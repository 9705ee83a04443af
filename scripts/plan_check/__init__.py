"""Compares predictions of podm info --plan with runs of podm mesh."""
