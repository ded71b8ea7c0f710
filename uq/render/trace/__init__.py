"""Traces: where a number comes from, and the same number computed again.

Reading order; each part imports only those above it:

    verbs      the verbs whose numbers have keys. To add one
    trace      origin of one number of a result, the rows behind it, and its recomputation
"""
