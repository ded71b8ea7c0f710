"""Traces: where a number comes from, and the same number computed again.

Reading order; each part imports only those above it:

    citations  summary and references of an estimator, from its docstring
    row_sets   rows of a result behind a number: runs of rows, block by block of the design
    verbs      the verbs whose numbers have keys
    trace      origin of one number of a result, and its recomputation
"""
