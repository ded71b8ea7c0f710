"""Branches of periodic orbits: over the forcing frequency, over the gaps, and along slow wear.

    orbits          periodic orbits by Newton's method
    bifurcations    what happens between two neighbouring orbits
    path            a branch along a parameter, through folds
    worn_orbit      one stable orbit along infinitely slow wear

`models.beam.explore` returns them labelled.
"""
