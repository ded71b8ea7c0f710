"""Rows carried out: here, in separate processes, on dask workers.

Reading order: `runner` leads from a study to its result. Its `executor` decides who computes; its
`dispatch` takes the rows in order, cuts them into chunks and has each computed here or on workers.

- Here: `isolation` starts a `child` process that rows may crash or never leave; `children` are
  several, of which each call takes one.
- On workers: `sent_chunks` sends chunks, and sends them again if a worker is killed; `workers` is
  what a run sees of a `local_cluster` of threads, or of a `remote_cluster`; `dask_task` is their
  task, which has a child compute.
- `again` computes a row of a result again, `alone` one without a study; `loading` finds out what a
  function returns, `scales` whether its lives scale as declared.
- Beside them: `options` (what the user chooses and sees), `planning` (what a run will cost),
  `environment` (what makes another process compute as this one).
"""
