"""The mole: a solenoid throws a bar against a stop, and the mole creeps forward against friction.

After J.-H. Ho, V.-D. Nguyen and K.-C. Woo, "Nonlinear dynamics of a new electro-vibro-impact
system", Nonlinear Dyn. 63 (2011) 35.

Reading order; each part imports only those above it:

    parameters    inputs, settings and outputs
    uncertain     laws of inputs in a new study
    theory        the equations
    exact         one mole at a time: the reference
    lanes         thirty-two moles at a time: the propagator of studies
    response      settled motion, its averages and its regime
    drive         one mole in slow time: distances, and the temperature of its coil
    drives        n moles in slow time, by settled responses along the way
    batch         from rows of a study to outputs
    trajectory    one time history
    explore       histories, sections and diagrams for notebooks
    paper         the paper's claims compared with the model
"""

from typing import Any

from models.mole.parameters import OUTPUTS, Params, Settings, coordinates
from models.mole.uncertain import UNCERTAIN
from uq.contract import Model, Trajectory


def _batch(x: Any, seed: Any, settings: Settings) -> Any:
    from models.mole.batch import batch  # imports numba only when needed

    return batch(x, seed, settings)


def _simulate(params: Params, settings: Settings, seed: int = 0) -> Trajectory:
    from models.mole.trajectory import simulate

    return simulate(params, settings, seed)


MODEL = Model(
    name="mole",
    title="electro-vibro-impact ground mole that creeps forward against dry friction",
    version="9",
    parameters=Params,
    settings=Settings,
    outputs=OUTPUTS,
    batch=_batch,
    simulate=_simulate,
    coordinates=coordinates,
    dimensions={
        "distance": ("m", "distance driven"),
        "temperature": ("K", "rise of the coil's temperature"),
    },
    block=256,
    references=(
        "J.-H. Ho, V.-D. Nguyen, K.-C. Woo, Nonlinear dynamics of a new electro-vibro-impact "
        "system, Nonlinear Dyn. 63 (2011) 35-49",
        "E. Pavlovskaia, M. Wiercigroch, C. Grebogi, Modeling of an impact system with a drift, "
        "Phys. Rev. E 64 (2001) 056224 (the soil ahead of the mole)",
    ),
    headline=("progression_rate", "impact_work_rate"),
    row_name=("mole", "moles"),
    uncertain=UNCERTAIN,
)
