"""Code that reproduces the paper; studies do not need it.

``table1`` prints its Table 1: ``python -m models.vibrator.paper.table1``.
"""
