"""Code that reproduces the paper; nothing else needs it.

``facts`` compares its statements with the model: ``python -m models.beam.paper.facts``.
"""
