"""Analyses that run a model themselves: one row, basins of attraction, rare events.

- `simulation`: one row as a Dataset, with its time history.
- `row_again`: a row of a result, computed again.
- `basins`, on a `grid` of parameters, whose rows settle on `attractors`.
- `rare_events`, by `subset_simulation` or importance sampling around `design_points`. Both evaluate
  a `limit_state`, which runs the model.
- `updating`: a study or a result, updated with inspections, with `new_rows` (`given_rows` of its
  study) where its own cannot show what the inspections leave.
"""
