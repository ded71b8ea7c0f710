"""The verbs of ``uq``: what each takes, and what it calls.

Reading order; each part imports only those above it:

    studies   the verbs that take a model or a study file
    results   the verbs that take a result: its run, and what it says
    learning  the verbs that learn from inspections
"""
