"""The vibrator: two unbalanced motors on one body, which must self-synchronise.

After J. Michalczyk and G. Cieplok, "Disturbances in self-synchronisation of vibrators in vibratory
machines", Arch. Min. Sci. 59 (2014).

Read `parameters`, then `batch`, from rows to outputs. It builds on, from the bottom up: `theory` of
synchronous running, `equations` of motion, the propagators `lanes` and `exact`, and `start` from
standstill. `trajectory` is one labelled run; `paper` reproduces the paper.
"""

from typing import Any

from models.vibrator.parameters import OUTPUTS, Params, Settings, coordinates
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
    version="3",
    parameters=Params,
    settings=Settings,
    outputs=OUTPUTS,
    batch=_batch,
    simulate=_simulate,
    coordinates=coordinates,
    cheap={"theory_disphasing_angle": _theory_batch},
    block=256,
    references=(
        "J. Michalczyk, G. Cieplok, Disturbances in self-synchronisation of vibrators in vibratory "
        "machines, Arch. Min. Sci. 59 (2014)",
    ),
)
