"""The loosely supported beam: a rod rattling between two elastic stops, which wear.

After J. Knudsen and A. R. Massih, "Impact work-rate and wear of a loosely supported beam subject
to harmonic excitation", ASME IMECE 2002, and J. Sound Vib. 278 (2004) 1025.
"""

from typing import Any

from models.beam.parameters import OUTPUTS, Params, Settings, coordinates
from uq.contract import Model, Trajectory


def _batch(x: Any, seed: Any, settings: Settings) -> Any:
    from models.beam.batch import batch  # numba only when something is computed

    return batch(x, seed, settings)


def _simulate(params: Params, settings: Settings, seed: int = 0) -> Trajectory:
    from models.beam.trajectory import simulate

    return simulate(params, settings, seed)


MODEL = Model(
    name="beam",
    title="loosely supported beam rattling between two elastic stops that wear",
    version="5",
    parameters=Params,
    settings=Settings,
    outputs=OUTPUTS,
    batch=_batch,
    simulate=_simulate,
    coordinates=coordinates,
    dimensions={"depth": ("m", "growth of the gap by wear")},
    random=True,
    random_unless={"random_force_level": 0.0},
    block=1024,
    references=(
        "J. Knudsen, A. R. Massih, Impact work-rate and wear of a loosely supported beam subject "
        "to harmonic excitation, ASME IMECE 2002",
        "J. Knudsen, A. R. Massih, J. Sound Vib. 278 (2004) 1025",
    ),
)
