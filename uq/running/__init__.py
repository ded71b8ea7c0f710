"""Rows carried out: here, in separate processes, on a dask cluster.

Reading order: `runner` leads from a study to its result. Its `executor` decides who computes; its
`dispatch` takes the rows in order, cuts them into chunks and has each computed here or by a `crew`.

- On this computer: `local_processes` is a crew of as many processes as there are `cores`;
  `isolation` starts each, a `child` that rows may crash or never leave, and starts it again.
- On a cluster: `sent_chunks` sends chunks, and sends them again if a worker is killed; `workers` is
  what it sees of a `remote_cluster`; `dask_task` is their task.
- Beside them: `options` (what the user chooses and sees), `planning` (what a run will cost),
  `environment` (what makes another process compute as this one).
"""
