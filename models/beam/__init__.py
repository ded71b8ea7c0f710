"""The loosely supported beam: a rod rattling between two elastic stops, which wear.

After J. Knudsen and A. R. Massih, "Impact work-rate and wear of a loosely supported beam subject
to harmonic excitation", ASME IMECE 2002, and J. Sound Vib. 278 (2004) 1025.

Reading order; each part imports only those above it:

    parameters    inputs and settings
    processes     which processes beside wear by impact are on, and what scales lives
    outputs       what is computed
    uncertain     laws of inputs in a new study
    structure     the rod as one oscillator per mode, and the load on it
    exact         one propagator: from event to event, the reference
    lanes         the other: many beams at a time in fixed steps, twenty times as fast
    start         propagator, gaps and state at the start
    response      the settled response at constant gaps
    wear          lives of beams whose gaps grow with the impact work
    units         conversion of dimensionless results to units
    batch         from rows of parameters to outputs, by wear by impact alone
    service       the same over years of duty, creep and wear of both bodies: all rows
    trajectory    one labelled time history
    branches      periodic orbits followed over frequency, gap and wear
    explore       labelled data for notebooks
    paper         the published facts compared with the model
"""

from typing import Any

from models.beam.outputs import OUTPUTS, coordinates
from models.beam.parameters import Params, Settings
from models.beam.processes import refusal
from models.beam.uncertain import UNCERTAIN
from uq.contract import Kept, Model, Trajectory


def _batch(x: Any, seed: Any, settings: Settings) -> Any:
    from models.beam.service.batch import batch  # imports numba only when needed

    return batch(x, seed, settings)


def _again(x: Any, seed: Any, settings: Settings, kept: Kept) -> Any:
    from models.beam.service.again import again

    return again(x, seed, settings, kept)


def _simulate(params: Params, settings: Settings, seed: int = 0) -> Trajectory:
    from models.beam.trajectory import simulate

    return simulate(params, settings, seed)


MODEL = Model(
    name="beam",
    title="loosely supported beam rattling between two elastic stops that wear",
    version="12",
    parameters=Params,
    settings=Settings,
    outputs=OUTPUTS,
    batch=_batch,
    simulate=_simulate,
    coordinates=coordinates,
    refusal=refusal,
    dimensions={
        "depth": ("m", "depth of the scar in the cladding"),
        "instant": ("s", "time since wear began"),
        "growth": ("m", "growth of the gap"),
        "right_growth": ("m", "growth of the right gap"),
        "left_growth": ("m", "growth of the left gap"),
    },
    random=True,
    random_unless={"random_force_level": 0.0},
    again=_again,
    block=1024,
    references=(
        "J. Knudsen, A. R. Massih, Impact work-rate and wear of a loosely supported beam subject "
        "to harmonic excitation, ASME IMECE 2002",
        "J. Knudsen, A. R. Massih, J. Sound Vib. 278 (2004) 1025",
        "Code_Aster, documentation of POST_USURE: volumes of scars, EDF's law of wear",
    ),
    headline=("first_time_to_depth", "work_rate_heavy"),
    row_name=("rod", "rods"),
    uncertain=UNCERTAIN,
)
