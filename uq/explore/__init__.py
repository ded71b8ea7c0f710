"""Analyses that run a model: single rows, grids, basins, rare events.

Reading order; each part imports only those above it:

    attractors         clustering of rows by the attractor on which they settled
    grid               grids: a model on evenly spaced values of some of its parameters
    subset_simulation  subset simulation
    given_rows         a study whose rows are given as normal scores of its inputs
    limit_state        limit state
    simulation         one row of a model as a Dataset, without a study
    basins             basins of attraction of any model, computed like a study
    design_points      first-order reliability
    wide_search        a search for parts of a rare event that another method missed
    new_rows           new rows where the inspections point
    row_again          one row of a result: found, and computed again with its time history
    rare_event_notes   caveats of the probability of a rare event
    updating           a study or a result, updated with inspections
    rare_events        rare events
"""
