"""The vibrator: two unbalanced motors on one body, which must self-synchronise.

After J. Michalczyk and G. Cieplok, "Disturbances in self-synchronisation of vibrators in vibratory
machines", Arch. Min. Sci. 59 (2014).

Reading order; each part imports only those above it:

    parameters    inputs, settings and outputs
    uncertain     laws of inputs in a new study
    theory        the averaged theory of synchronous running
    equations     the equations of motion
    exact         one propagator: any machine, one at a time
    lanes         the other: sixteen rigid machines at a time
    start         from standstill to the steady state
    run_down      from synchronous running to rest
    service       years of service: time to disphasing
    batch         from rows of a study to outputs
    trajectory    one labelled run
    paper         the paper's claims compared with the model
"""

import math
from typing import Any

from models.vibrator.parameters import OUTPUTS, Params, Settings, coordinates
from models.vibrator.uncertain import UNCERTAIN
from uq.contract import Model, Trajectory


def _batch(x: Any, seed: Any, settings: Settings) -> Any:
    from models.vibrator.batch import batch  # imports numba only when needed

    return batch(x, seed, settings)


def _theory_batch(x: Any, seed: Any, settings: Settings) -> Any:
    from models.vibrator.batch import theory_batch

    return theory_batch(x, seed, settings)


def _simulate(params: Params, settings: Settings, seed: int = 0) -> Trajectory:
    from models.vibrator.trajectory import simulate

    return simulate(params, settings, seed)


MODEL = Model(
    name="vibrator",
    title="vibratory machine whose two unbalanced motors must synchronise by themselves",
    version="6",
    parameters=Params,
    settings=Settings,
    outputs=OUTPUTS,
    batch=_batch,
    simulate=_simulate,
    coordinates=coordinates,
    dimensions={
        "instant": ("s", "time since the motors were switched on"),
        "run_down_phase": ("rad", "phase of vibrator 1 at which the motors are switched off"),
    },
    cheap={"theory_disphasing_angle": _theory_batch},
    random=True,
    random_unless={"spring_life": math.inf},
    block=256,
    references=(
        "J. Michalczyk, G. Cieplok, Disturbances in self-synchronisation of vibrators in vibratory "
        "machines, Arch. Min. Sci. 59 (2014)",
    ),
    headline=("disphasing_angle", "synchronisation_time"),
    row_name=("machine", "machines"),
    uncertain=UNCERTAIN,
)
