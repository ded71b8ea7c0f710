"""The verbs of ``uq``: what each takes, and what it calls.

Heavy modules are imported inside the verbs, so that ``uq --help`` responds at once.
"""
