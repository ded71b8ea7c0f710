"""Analyses that run a model themselves: one row, basins of attraction, rare events.

- `one_row`: one row; `simulation`: the same as a Dataset, with its time history.
- `basins`, on a `grid` of parameters, whose rows settle on `attractors`.
- `rare_events`, by `subset_simulation` or importance sampling around `design_points`. Both evaluate
  a `limit_state`, which runs the model.
"""
