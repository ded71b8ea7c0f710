"""Analyses that run a model: single rows, grids, basins, rare events.

Reading order; each part imports only those above it:

    basins               basins of attraction of any model on a grid of its parameters
    subset_simulation    subset simulation
    limit_state          limit-state function
    new_rows             new rows in the posterior region, if a result has too few rows there
    next_rows            next rows, where a result of few rows gains most
    single_rows          single rows: a single run of a model, or a recomputed row of a result
    importance_sampling  importance sampling of rare events
    active_learning      active learning of rare events
    updating             a study or a result, updated with inspections
    rare_events          rare events
"""
