"""What the paper prints, computed again; nothing else needs it.

facts    its statements beside ours: ``python -m models.beam.paper.facts``
"""
