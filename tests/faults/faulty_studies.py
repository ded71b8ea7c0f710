"""What tests of faulty rows and killed processes share."""

from uq.running import runner

PATIENCE = 60.0
"""How long a busy machine may take [s]."""

FAULTY = "faulty_models:FAULTY"


def computed_here(study):
    """Return a study computed with nothing that could go wrong."""
    return runner.compute(study, workers=0)
