"""Rows computed in processes and on workers, kept on disk, resumed and extended.

Reading order; each part imports only those above it:

    options         options of a run and its progress; no option changes a bit of a sound row
    child           a process that computes rows for its parent
    chunk_file      chunk files: rows as the bytes of one structured array
    environment     other processes, which import and compile as this one
    tally           the rows of a run
    isolation       rows computed in a separate process, which they may crash or never leave
    records         the records of a run's journal
    children        processes that compute rows, as many as are asked at the same time
    scaling_checks  the scales that a machine from outside declares, held to what it returns
    merge           a result that is written in parts: its variables, then rows in their places
    row_folder      the folder beside a result that keeps its rows until it is complete
    dask_task       the task of a dask worker: plain data in, plain data out
    workers         dask workers, whoever started them, and the chunks of rows that they compute
    loading         studies and models
    disk_store      rows kept on disk as they arrive, whatever happens to the process
    status          progress of a run, even one under way
    local_cluster   dask workers of this computer
    remote_cluster  dask workers of an existing cluster
    recomputed_row  a row of a result, computed again here and compared with the one there
    single_row      one row of a model, in a process of its own if the model may end it
    resuming        starting a run whose rows are kept on disk, or resuming it
    dispatch        the rows of one run: taken in order, computed here or on workers, and kept
    executor        who computes rows
    planning        cost of a study, estimated from a few of its rows
    runner          from a study to its result
    amending        a result with more samples, or with its failed rows computed again
    verification    verification of a result
"""
