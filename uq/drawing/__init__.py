"""Figures, one kind in a file; `uq.plots` is their public face."""
