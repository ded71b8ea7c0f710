"""Wear of one gap: a model with known answers that is integrated in slow time, as machines are.

Reading order; each part imports only those above it:

    declarations    inputs, settings and outputs, with the equations
    growth          the equations as kernels of the integrator of slow time
    batch           from rows of parameters to outputs
"""

from typing import Any

from models.gap_wear.declarations import OUTPUTS, GapWearParameters, GapWearSettings, coordinates
from uq.contract import Model


def _batch(x: Any, seed: Any, settings: GapWearSettings) -> Any:
    from models.gap_wear.batch import batch  # imports numba only when needed

    return batch(x, seed, settings)


MODEL = Model(
    name="gap-wear",
    title="Wear of one gap that also opens by itself: known times in many special cases",
    version="2",
    parameters=GapWearParameters,
    settings=GapWearSettings,
    outputs=OUTPUTS,
    batch=_batch,
    coordinates=coordinates,
    dimensions={
        "depth": ("m", "depth of the rod's scar"),
        "growth": ("m", "growth of the gap"),
        "instant": ("s", "time since the beginning"),
    },
    block=64,
    references=("Code_Aster, documentation of POST_USURE: volumes and depths of scars",),
)
