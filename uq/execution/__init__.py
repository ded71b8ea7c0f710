"""Rows computed in processes and on workers, kept on disk, resumed and extended.

Reading order; each part imports only those above it:

    workers         dask workers as a run sees them, whoever started them
    options         what a user chooses and sees of a run
    chunk_file      chunk files: rows as the bytes of one structured array
    child           a process that computes rows for its parent
    environment     other processes, which import and compile as this one
    tally           the rows of a run
    probe           a process that runs a few rows of a function to see what it returns
    isolation       rows computed in a separate process, which they may crash or never leave
    records         the records of a run's journal
    scaling_checks  the scales that a machine from outside declares, held to what it returns
    children        processes that compute rows, as many as are asked at the same time
    row_folder      the folder beside a result that keeps its rows until it is complete
    merge           from chunk files to one result, one file at a time
    loading         studies and models
    dask_task       the task of a dask worker: plain data in, plain data out
    status          how far a run is, even one under way
    disk_store      rows kept on disk as they arrive, whatever happens to the process
    recomputed_row  a row of a result, computed again here and compared with the one there
    single_row      one row of a model, in a process of its own if the model may end it
    local_cluster   dask workers of this computer
    sent_chunks     chunks sent to dask workers: what returns, and what is sent again
    remote_cluster  dask workers of an existing cluster
    resuming        starting a run whose rows are kept on disk, or resuming it
    dispatch        the rows of one run: taken in order, computed here or on workers, and kept
    executor        who computes rows
    runner          from a study to its result
    planning        what a study will cost: a few of its rows are run, spread over all of them
    amending        a result with more samples, or with its failed rows computed again
    verification    whether a result is as written, and would be the same if computed here
"""
