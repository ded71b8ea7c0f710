"""Units and names of the results of `models.beam.explore`."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from models.beam.explore.sweeps import Sweep
from models.beam.parameters import REGIMES, SITES, Params, Rows, Settings
from models.beam.structure.modal import Array

WORDS = np.array([*REGIMES, "none"])  # -1 is the last
_SITE = {"site": list(SITES)}
_ABOUT = {
    "time": ("s", "time of wear"),
    "dimensionless_time": ("1", "T: time over S/(k k_c X0 w0), k of the right site"),
    "gap": ("m", "gap between rod and stop"),
    "gap_ratio": ("1", "left gap over right gap, x_2/x_1"),
    "work_rate": ("W", "impact work-rate"),
    "mean_work": ("1", "<u_i>: work-rate over k_c X0^2 w0"),
    "regime": ("1", "type of response"),
    "period": ("1", "period of the response in forcing periods, 0 if aperiodic"),
    "change_time": ("s", "time at which the regime changes"),
    "change_gap": ("m", "gap at which the regime changes"),
    "change_from": ("1", "regime before the change"),
    "change_to": ("1", "regime after the change"),
    "displacement": ("m", "tip displacement"),
    "velocity": ("m s-1", "tip velocity"),
    "phase": ("1", "forcing periods"),
    "forcing_frequency": ("Hz", "frequency of the force"),
    "frequency_ratio": ("1", "omega: forcing frequency over fundamental frequency"),
    "impact_velocity": ("m s-1", "tip velocity at impact on the right stop"),
    "dimensionless_impact_velocity": ("1", "tip velocity at impact on the right stop, over X0 w0"),
}


def check_counts(**counts: int) -> None:
    """Refuse counts that are not positive integers."""
    for name, count in counts.items():
        if not isinstance(count, int) or count < 1:
            raise ValueError(f"{name} must be a positive whole number, not {count!r}")


def equal_rows(params: Params, n: int) -> Rows:
    """Return the parameters of n equal beams, each field of shape (n,)."""
    if params.random_force_level > 0:
        raise ValueError("defined for a harmonic force only: random_force_level > 0")
    return Params._make(np.full(n, float(value)) for value in params)


def blank(n: int) -> tuple[Array, NDArray[np.int8], Array]:
    """Return the work, regime and period of n beams that no propagator could follow."""
    return np.full((n, 2), np.nan), np.full(n, -1, np.int8), np.full(n, np.nan)


def dataset(variables: dict[str, Any], settings: Settings, sweep: Sweep = "none") -> xr.Dataset:
    """Return variables, given as (dimensions, values), with units and meanings."""
    labelled = {
        name: (dims, values, {"units": _ABOUT[name][0], "long_name": _ABOUT[name][1]})
        for name, (dims, values) in variables.items()
    }
    for name in labelled.keys() & {"regime", "change_from", "change_to"}:
        labelled[name][2]["flag_meanings"] = " ".join(REGIMES)
    propagator = settings.propagator if sweep == "none" else "exact"
    return xr.Dataset(labelled, _SITE, {"model": "beam", "propagator": propagator, "sweep": sweep})
