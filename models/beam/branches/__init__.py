"""Branches of periodic orbits: over the forcing frequency, over the gaps, and along slow wear.

Reading order; a module imports only those above it:

    orbits          periodic orbits by Newton's method
    bifurcations    what happens between two neighbouring orbits
    path            a branch along a parameter, through folds
    worn_orbit      one stable orbit along infinitely slow wear
"""
