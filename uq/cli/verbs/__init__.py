"""The verbs of ``uq``: what each takes, and what it calls.

Reading order; each part imports only those above it:

    results  the verbs that take a result, or learn from inspections
    studies  the verbs that take a model or a study file
"""
