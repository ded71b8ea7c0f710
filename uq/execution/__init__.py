"""Rows computed in processes and on workers, kept on disk, resumed and extended.

Reading order; each part imports only those above it:

    options         options of a run and its progress
    child           a process that computes rows for its parent
    tally           rows of a run
    environment     start of child processes with the same imports and compilation as this
    row_folder      folder beside a result that keeps its rows, and the records of its journal
    isolation       rows computed in separate processes, in case they crash or hang
    disk_store      crash-safe storage of arriving rows on disk
    dask_task       the task of a dask worker: plain data in, plain data out
    scaling_checks  check the scaling exponents declared by an external machine against
    resuming        start or resume a run whose rows are kept on disk
    workers         dask workers, local or on a cluster
    loading         load studies and models, and run one row of a model
    clusters        dask workers of this computer, or of an existing cluster
    recomputation   rows computed again: one, or all from what they have kept
    queues          rows computed by the jobs of a queueing system
    executor        rows of one run
    planning        cost of a study, estimated from a few of its rows
    runner          run of a study: rows in chunks, on this computer or on dask workers
    amending        changes to an existing result: extend it, rerun failed rows, or verify rows
"""
