"""Analyses that run a model: single rows, grids, basins, rare events.

Reading order; each part imports only those above it:

    basins               basins of attraction of any model on a grid of its parameters
    subset_simulation    subset simulation: a rare event as likely conditional events
    limit_state          limit state: distance of rows beyond a threshold, in standard normal space
    new_rows             new rows in the posterior region, if a result has too few rows there
    single_rows          single rows: a single run of a model, or a recomputed row of a result
    importance_sampling  importance sampling of rare events
    updating             a study or a result, updated with inspections
    rare_event_notes     caveats of a rare-event probability that its numbers do not show
    rare_events          probability that an output exceeds a threshold, by the method that suits
"""
