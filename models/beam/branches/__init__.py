"""Branches of periodic orbits: over the forcing frequency, over the gaps, and along slow wear.

`models.beam.branches.explore` returns them labelled.
"""
