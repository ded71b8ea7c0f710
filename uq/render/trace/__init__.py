"""Traces: where a number comes from, and the same number computed again.

Reading order; each part imports only those above it:

    citations       summary and references of an estimator, from its docstring
    row_sets        rows of a result behind a number: runs of rows, block by block of the design
    origin          origin of a number: estimators, rows and their states
    indices         the numbers of `uq sensitivity` and their origins
    inputs          the numbers of the inputs that a report shows and their origins
    learning        the numbers of `uq update` and their origins
    summary         the numbers of `uq summary` and their origins
    convergence     the numbers of `uq convergence` and their origins
    answer          the numbers of the answer and their origins
    fleet           the numbers of `uq fleet` and their origins
    levels          the numbers of `uq levels` and their origins
    two_fidelities  the numbers of `uq twin` and their origins
    what_if         the numbers of `uq what-if` and their origins
    verbs           the verbs whose numbers have keys. To add one, write its JSON and origins
    trace           origin of one number of a result, and its recomputation
"""
