"""Rows computed in processes and on workers, kept on disk, resumed and extended.

Reading order; each part imports only those above it:

    options         options of a run and its progress; no option changes a bit of a sound row
    child           a process that computes rows for its parent
    tally           rows of a run
    environment     other processes, which import and compile as this one
    row_folder      folder beside a result that keeps its rows, and the records of its journal
    isolation       rows computed in separate processes, which they may crash or never leave
    disk_store      rows kept on disk as they arrive, whatever happens
    status          progress of a run, even one under way
    dask_task       the task of a dask worker: plain data in, plain data out
    scaling_checks  the scales that a machine from outside declares, held to what it returns
    resuming        starting a run whose rows are kept on disk, or resuming it
    workers         dask workers, whoever started them, and the chunks of rows that they compute
    loading         studies and models
    clusters        dask workers of this computer, or of an existing cluster
    recomputed_row  a row of a result, computed again here and compared with the one there
    single_row      one row of a model, in a process of its own if the model may end it
    executor        rows of one run
    planning        cost of a study, estimated from a few of its rows
    runner          from a study to its result
    amending        existing result: extended, its failed rows computed again, or verified
"""
