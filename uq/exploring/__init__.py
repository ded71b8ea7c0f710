"""Analyses that run a model themselves: one row, basins of attraction, rare events.

- `simulation`: one row.
- `basins`, on a `grid` of parameters, which tells `attractors` apart.
- `rare_events`, by `subset_simulation` or importance sampling around `design_points`. Both ask a
  `limit_state`, whose rows an `evaluator` computes; `rare_event_intervals` says what they support.
"""
