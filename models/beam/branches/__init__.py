"""Branches of periodic orbits over forcing frequency and gaps, and along slow wear.

Reading order; a module imports only those above it:

    orbits          periodic orbits by Newton's method
    bifurcations    bifurcations and grazing between two neighbouring orbits
    path            a branch along a parameter, through folds
    worn_orbit      one stable orbit under infinitely slow wear
"""
