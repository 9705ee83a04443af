"""Predictions of podm info --plan compared with runs of podm mesh."""
