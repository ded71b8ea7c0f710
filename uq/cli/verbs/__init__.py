"""The verbs of ``uq``: what each is given, and what it calls.

Heavy modules are imported inside the verbs, so that ``uq --help`` answers at once.
"""
