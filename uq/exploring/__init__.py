"""Analyses that run a model for themselves: one row, basins of attraction, rare events."""
