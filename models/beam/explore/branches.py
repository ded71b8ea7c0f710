"""Branches of periodic orbits, over frequency, gap and wear, labelled for plotting."""

from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from models.beam.branches.orbits import settled_orbit
from models.beam.branches.path import Path, Setting, trace
from models.beam.branches.worn_orbit import wear_along
from models.beam.exact.tuning import Tuning
from models.beam.explore.orbit_labels import labelled_events, labelled_orbits, named
from models.beam.parameters import Params, Settings
from models.beam.start import initial_gaps, wear_shares
from models.beam.structure.modal import Array, beams
from models.beam.units import wear_per_work

Parameter = Literal["forcing_frequency", "gap"]

_ABOUT: dict[str, tuple[str, str]] = {
    "forcing_frequency": ("Hz", "frequency of the force"),
    "gap": ("m", "mean of both gaps"),
}


def continue_orbit(
    params: Params,
    settings: Settings | None = None,
    parameter: Parameter = "forcing_frequency",
    *,
    stop: float,
    start: float | None = None,
    period: int = 1,
    state: ArrayLike | None = None,
    stable_only: bool = True,
    largest_step: float = 0.05,
    tolerance: float = 1e-5,
) -> xr.Dataset:
    """Follow a periodic orbit along the forcing frequency or the gap, through folds.

    Parameters
    ----------
    params : Params
        Each field a float.
    settings : Settings, optional
        Only `elements` and `modes` are used.
    parameter : {"forcing_frequency", "gap"}
        With ``gap`` both gaps grow in proportion, everything else being constant.
    stop : float
        Value of the parameter where the branch ends [Hz or m]; it also ends if it returns to its
        start.
    start : float, optional
        Value where it begins; by default that of `params`.
    period : int
        Of the orbit, in periods of the force.
    state : array_like, shape (2 m,), optional
        A guess of the orbit at `start`, such as a ``state`` of a result; by default a stable orbit
        is found by letting the beam settle from the initial state in `params`.
    stable_only : bool
        Whether to end the branch where stability is lost.
    largest_step : float
        Relative to the range and to the state.
    tolerance : float
        Of event location, relative to the same.

    Returns
    -------
    xarray.Dataset
        Along ``point``: the parameter; ``gaps`` [m]; ``work_rate`` [W] and
        ``dimensionless_work_rate`` <u_i> (eqs 6 to 8), the mean of k_c X0^2 w0;
        ``peak_contact_force`` [N]; ``impact_velocity`` [m s-1] at x_c = +x_1, v > 0, along
        ``impact``; ``multiplier_real`` and ``multiplier_imag``, the largest modulus first;
        ``stable``; ``clearance`` [m], the smallest distance from a stop's face at which the tip
        turns; ``state``. Along ``event``: ``event`` (fold, period-doubling, neimark-sacker,
        symmetry-breaking, grazing), ``event_value`` of the parameter, ``event_gaps`` [m],
        ``event_stable_before`` and ``event_stable_after``, ``event_multiplier``, the largest
        modulus before. Attribute ``end``: the cause of lost stability, or ``stop``, ``start``,
        ``stalled``, ``budget``; see `models.beam.branches.path.Branch`.

    Raises
    ------
    ValueError
        If no such orbit is found at the start, an argument is not as stated, the load is random, or
        the settings ask for residual flexibility.
    """
    if parameter not in _ABOUT:
        raise ValueError(f"parameter must be 'forcing_frequency' or 'gap', not {parameter!r}")
    if not np.isfinite(stop):
        raise ValueError(f"stop must be a number: {stop!r}")
    if start is None:
        start = params.forcing_frequency if parameter == "forcing_frequency" else params.initial_gap
    forcing = start if parameter == "forcing_frequency" else params.forcing_frequency
    params = params._replace(forcing_frequency=forcing)
    tuning = _tuning(params, settings or Settings())
    x0 = params.initial_gap
    new = initial_gaps(params)
    if parameter == "forcing_frequency":

        def setting(value: float) -> Setting:
            return Setting(tuning.at(2 * np.pi * value), new, np.zeros(2), 1 / value)

    else:
        beam = tuning.at(tuning.forcing)

        def setting(value: float) -> Setting:
            return Setting(beam, new * value / x0, new / x0, 0.0)

    at = setting(start)
    orbit = settled_orbit(at.beam, _first_state(params, tuning, state), at.gaps, period)
    path = Path(setting, orbit, start, stop, tolerance)
    branch = trace(path, orbit, stable_only, largest_step)
    frequencies = branch.values if parameter == "forcing_frequency" else forcing
    unit, meaning = _ABOUT[parameter]
    about = named(unit, meaning)
    ds = labelled_orbits(
        params, tuning, branch.orbits, np.broadcast_to(frequencies, len(branch.orbits))
    )
    ds = ds.merge(labelled_events(params, branch.events, about)).assign_attrs(end=branch.end)
    return ds.assign_coords({parameter: ("point", branch.values, about)})


def follow_wear(
    params: Params,
    settings: Settings | None = None,
    *,
    stop: float,
    period: int = 1,
    state: ArrayLike | None = None,
    accuracy: float = 1e-5,
) -> xr.Dataset:
    """Let both gaps grow by infinitely slow wear along a stable orbit (eqs 9 to 12).

    Parameters
    ----------
    params : Params
        Each field a float.
    settings : Settings, optional
        Only `elements` and `modes` are used.
    stop : float
        Gap of the wider site where the path ends, if still stable [m].
    period : int
        Of the orbit, in periods of the force.
    state : array_like, shape (2 m,), optional
        As in `continue_orbit`.
    accuracy : float
        Error of a step, of the gaps in initial gaps and of the time relative to it.

    Returns
    -------
    xarray.Dataset
        As from `continue_orbit`, with ``time`` [s] and ``dimensionless_time`` T in place of the
        parameter. ``event_value`` is the right gap [m]. Attribute ``end``: the cause of lost
        stability, ``stop``, or ``no-impact`` where contact fades away.

    Raises
    ------
    ValueError
        If no stable orbit of this period is found at the initial gaps, an argument is not as
        stated, the load is random, or the settings ask for residual flexibility.
    """
    if not accuracy > 0:
        raise ValueError(f"accuracy must be positive: {accuracy!r}")
    tuning = _tuning(params, settings or Settings())
    beam = tuning.at(tuning.forcing)
    x0 = params.initial_gap
    orbit = settled_orbit(beam, _first_state(params, tuning, state), initial_gaps(params), period)
    worn = wear_along(beam, orbit, wear_shares(params), stop / x0, accuracy)
    frequencies = np.full(len(worn.orbits), params.forcing_frequency)
    ds = labelled_orbits(params, tuning, worn.orbits, frequencies)
    scaled = [event._replace(value=event.value * x0) for event in worn.events]
    ds = ds.merge(labelled_events(params, scaled, named("m", "right gap")))
    dimensionless = worn.time * 2 * np.pi * tuning.fundamental / tuning.forcing
    time = worn.time / (params.forcing_frequency * wear_per_work(params))
    return ds.assign_attrs(end=worn.end).assign_coords(
        time=("point", time, named("s", "time of wear")),
        dimensionless_time=("point", dimensionless, named("1", "T (eq 12)")),
    )


def _tuning(params: Params, settings: Settings) -> Tuning:
    if params.random_force_level > 0:
        raise ValueError("under a random load there are no periodic orbits: random_force_level > 0")
    if settings.residual_flexibility:
        raise ValueError("orbits are those of the exact propagator, without residual_flexibility")
    rows: Any = Params._make(np.array([value], float) for value in params)
    return Tuning(beams(rows, settings))


def _first_state(params: Params, tuning: Tuning, state: ArrayLike | None) -> Array:
    """Return the given state, or the initial state of the parameters."""
    if state is not None:
        given = np.asarray(state, float)
        if given.shape != (tuning.size,):
            raise ValueError(f"state must have {tuning.size} numbers, not shape {given.shape}")
        return given
    first = np.zeros(tuning.size)
    first[0] = params.initial_displacement / params.initial_gap
    first[tuning.size // 2] = params.initial_velocity / params.initial_gap / tuning.forcing
    return first
