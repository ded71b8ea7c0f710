"""Analyses that run a model: single rows, grids, basins, rare events.

Reading order; each part imports only those above it:

    basins               basins of attraction of any model on a grid of its parameters
    subset_simulation    subset simulation
    limit_state          limit state
    new_rows             new rows where the inspections point
    single_rows          single rows: of a model without a study, or of a result, computed again
    importance_sampling  importance sampling of rare events
    updating             a study or a result, updated with inspections
    rare_event_notes     caveats of the probability of a rare event
    rare_events          rare events
"""
