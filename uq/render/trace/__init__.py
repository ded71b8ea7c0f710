"""Traces: where a number comes from, and the same number computed again.

Reading order; each part imports only those above it:

    citations       summary and references of an estimator, from its docstring
    row_sets        rows of a result behind a number: runs of rows, block by block of the design
    origin          where a number comes from
    indices         the numbers of `uq sensitivity`, and where they come from
    inputs          the numbers of the inputs that a report shows, and where they come from
    learning        the numbers of `uq update`, and where they come from
    summary         the numbers of `uq summary`, and where they come from
    convergence     the numbers of `uq convergence`, and where they come from
    answer          the numbers of the answer, and where they come from
    fleet           the numbers of `uq fleet`, and where they come from
    levels          the numbers of `uq levels`, and where they come from
    two_fidelities  the numbers of `uq twin`, and where they come from
    what_if         the numbers of `uq what-if`, and where they come from
    verbs           the verbs whose numbers have keys. To add one
    trace           one number of a result: where it comes from, and the same computed again
"""
