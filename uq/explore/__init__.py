"""Analyses that run a model: single rows, grids, basins, rare events.

Reading order; each part imports only those above it:

    simulation         one row of a model as a Dataset, without a study
    subset_simulation  subset simulation
    given_rows         a study whose rows are given as normal scores of its inputs
    limit_state        the margin of rows beyond a threshold, on standard normal space
    grid               grids: a model on evenly spaced values of some of its parameters
    attractors         clustering of rows by the attractor on which they settled
    row_again          one row of a result: found, and computed again with its time history
    design_points      first-order reliability
    wide_search        a search for parts of a rare event that another method missed
    new_rows           new rows where the inspections point
    basins             basins of attraction of any model, computed like a study
    rare_events        rare events
    updating           a study or a result, updated with inspections
"""
