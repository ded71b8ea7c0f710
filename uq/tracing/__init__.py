"""Where a number comes from: its estimator, its source, its rows; and the number computed again.

Its key, the path in JSON, is that of `uq.keys`.

- `citations`: what a function estimates, and the source that its docstring cites.
- `row_sets`: which rows, in few words.
- `origin`: where a number comes from.
- `verbs`: the verbs whose numbers have keys; each says its JSON, and the `origin` of a number in it
  (`of_summary`, `of_answer`, `of_inputs`, `of_indices`, `of_levels`, `of_fleet`, `of_running`,
  `of_twin`, `of_what_if`).
- `tracing`: all of that for one key.
"""
