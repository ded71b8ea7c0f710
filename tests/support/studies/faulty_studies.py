"""What tests of faulty rows and killed processes share."""

from in_memory import compute

PATIENCE = 600.0
"""How long a busy machine may take [s]."""

FAULTY = "faulty_models:FAULTY"


def computed_here(study):
    """Return a study computed with nothing that could go wrong."""
    return compute(study, workers=0)
