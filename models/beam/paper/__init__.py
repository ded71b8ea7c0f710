"""What reproduces the paper; nothing else needs it.

``facts`` prints its statements beside ours: ``python -m models.beam.paper.facts``.
"""
