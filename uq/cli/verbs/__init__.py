"""The verbs of ``uq``: what each takes, and what it calls.

Reading order; each part imports only those above it:

    learning  the verbs that learn from inspections
    results   the verbs that take a result: its run, and what it says
    studies   the verbs that take a model or a study file
"""
