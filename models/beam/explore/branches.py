"""Branches of periodic orbits, over frequency, gap and wear, labelled for plotting."""

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from models.beam.branches.bifurcations import Event
from models.beam.branches.orbits import Orbit, settled_orbit
from models.beam.branches.path import Path, Setting, trace
from models.beam.branches.worn_orbit import wear_along
from models.beam.exact.tuning import Tuning
from models.beam.parameters import SITES, Params, Settings
from models.beam.structure.modal import Array, beams

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
        Its `elements` and `modes` count.
    parameter : {"forcing_frequency", "gap"}
        Under ``gap`` both gaps grow in proportion, everything else being held.
    stop : float
        Value of the parameter where the branch ends [Hz or m]; it also ends where it comes back to
        its start.
    start : float, optional
        Value where it begins; that of `params` unless given.
    period : int
        Of the orbit, in periods of the force.
    state : array_like, shape (2 m,), optional
        A guess of the orbit at `start`, as ``state`` of the result; unless given, a stable orbit
        is sought by letting the beam settle from the initial state in `params`.
    stable_only : bool
        Whether the branch ends where stability is lost.
    largest_step : float
        Of the range and of the state, both relative.
    tolerance : float
        Within which events are located, relative to the same.

    Returns
    -------
    xarray.Dataset
        Along ``point``: the parameter; ``gaps`` [m]; ``work_rate`` [W] and
        ``dimensionless_work_rate`` <u_i> (eqs 6 to 8), the mean of k_c X0^2 w0;
        ``peak_contact_force`` [N]; ``impact_velocity`` [m s-1] at x_c = +x_1, v > 0, along
        ``impact``; ``multiplier_real`` and ``multiplier_imag``, the largest modulus first;
        ``stable``; ``clearance`` [m], how near to a stop's face the tip turns; ``state``. Along
        ``event``: ``event`` (fold, period-doubling, neimark-sacker, symmetry-breaking, grazing),
        ``event_value`` of the parameter, ``event_gaps`` [m], ``event_stable_before`` and
        ``event_stable_after``, ``event_multiplier``, the largest modulus before. Attribute ``end``:
        the cause of lost stability, or ``stop``, ``start``, ``stalled``, ``budget``, see
        `models.beam.branches.path.Branch`.

    Raises
    ------
    ValueError
        If no such orbit is found at the start, or the load is random.
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
    new = np.array([1 + params.gap_asymmetry / 2, 1 - params.gap_asymmetry / 2])
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
    about = _named(unit, meaning)
    ds = _labelled(params, tuning, branch.orbits, np.broadcast_to(frequencies, len(branch.orbits)))
    ds = ds.merge(_events(params, branch.events, about)).assign_attrs(end=branch.end)
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
        Its `elements` and `modes` count.
    stop : float
        Gap of the wider site where the path ends, if stability lasts so long [m].
    period : int
        Of the orbit, in periods of the force.
    state : array_like, shape (2 m,), optional
        As in `continue_orbit`.
    accuracy : float
        Error of a step, of the gaps in initial gaps and of the time relative.

    Returns
    -------
    xarray.Dataset
        As that of `continue_orbit`, with ``time`` [s] and ``dimensionless_time`` T in place of the
        parameter. ``event_value`` is the right gap [m]. Attribute ``end``: the cause of lost
        stability, ``stop``, or ``no-impact`` where contact fades away.

    Raises
    ------
    ValueError
        If no stable orbit of this period is found at the initial gaps, or the load is random.
    """
    if not accuracy > 0:
        raise ValueError(f"accuracy must be positive: {accuracy!r}")
    tuning = _tuning(params, settings or Settings())
    beam = tuning.at(tuning.forcing)
    x0 = params.initial_gap
    gaps = np.array([1 + params.gap_asymmetry / 2, 1 - params.gap_asymmetry / 2])
    orbit = settled_orbit(beam, _first_state(params, tuning, state), gaps, period)
    share = np.array([1.0, params.wear_coefficient_ratio])
    worn = wear_along(beam, orbit, share, stop / x0, accuracy)
    frequencies = np.full(len(worn.orbits), params.forcing_frequency)
    ds = _labelled(params, tuning, worn.orbits, frequencies)
    scaled = [event._replace(value=event.value * x0) for event in worn.events]
    ds = ds.merge(_events(params, scaled, _named("m", "right gap")))
    dimensionless = worn.time * 2 * np.pi * tuning.fundamental / tuning.forcing
    wear = params.wear_coefficient / params.contact_area * params.contact_stiffness * x0
    time = worn.time / (params.forcing_frequency * wear)
    return ds.assign_attrs(end=worn.end).assign_coords(
        time=("point", time, _named("s", "time of wear")),
        dimensionless_time=("point", dimensionless, _named("1", "T (eq 12)")),
    )


def _tuning(params: Params, settings: Settings) -> Tuning:
    if params.random_force_level > 0:
        raise ValueError("under a random load there are no periodic orbits: random_force_level > 0")
    if settings.residual_flexibility:
        raise ValueError("orbits are those of the exact propagator, without residual_flexibility")
    rows: Any = Params._make(np.array([value], float) for value in params)
    return Tuning(beams(rows, settings))


def _first_state(params: Params, tuning: Tuning, state: ArrayLike | None) -> Array:
    """Return the state given, or that of the parameters."""
    if state is not None:
        given = np.asarray(state, float)
        if given.shape != (tuning.size,):
            raise ValueError(f"state must have {tuning.size} numbers, not shape {given.shape}")
        return given
    first = np.zeros(tuning.size)
    first[0] = params.initial_displacement / params.initial_gap
    first[tuning.size // 2] = params.initial_velocity / params.initial_gap / tuning.forcing
    return first


def _labelled(
    params: Params, tuning: Tuning, orbits: Sequence[Orbit], frequency: Array
) -> xr.Dataset:
    """Give the orbits of a branch their units."""
    x0, k_c = params.initial_gap, params.contact_stiffness
    work = np.array([orbit.work for orbit in orbits])
    impacts = np.full((len(orbits), max(len(o.impact_velocities) for o in orbits)), np.nan)
    for row, orbit in zip(impacts, orbits, strict=True):
        row[: len(orbit.impact_velocities)] = orbit.impact_velocities
    multipliers = np.array([orbit.multipliers for orbit in orbits])
    f = frequency[:, None]
    sited, multiplied = ("point", "site"), ("point", "multiplier")
    variables: dict[str, tuple[Any, Array, str, str]] = {
        "gaps": (sited, x0 * np.array([o.gaps for o in orbits]), "m", "gap of each site"),
        "work_rate": (sited, k_c * x0**2 * f * work, "W", "impact work-rate of each site"),
        "dimensionless_work_rate": (
            sited,
            f / tuning.fundamental * work,
            "1",
            "impact work-rate of each site over k_c X0^2 w0",
        ),
        "peak_contact_force": (
            sited,
            k_c * x0 * np.array([o.peak for o in orbits]),
            "N",
            "largest contact force of each site",
        ),
        "impact_velocity": (
            ("point", "impact"),
            x0 * 2 * np.pi * f * impacts,
            "m s-1",
            "velocity at which the right stop is met",
        ),
        "multiplier_real": (multiplied, multipliers.real, "1", "real part of the multipliers"),
        "multiplier_imag": (multiplied, multipliers.imag, "1", "imaginary part of the multipliers"),
        "stable": ("point", np.array([o.is_stable for o in orbits]), "1", "whether it is stable"),
        "clearance": (
            "point",
            x0 * np.array([o.clearance for o in orbits]),
            "m",
            "how near to a stop's face the tip turns",
        ),
        "state": (
            ("point", "component"),
            np.array([o.state for o in orbits]),
            "1",
            "z and dz/d(Omega t) of each mode at phase 0 of the force, over X0",
        ),
    }
    return xr.Dataset(
        {
            name: (dims, values, _named(unit, meaning))
            for name, (dims, values, unit, meaning) in variables.items()
        },
        {"site": list(SITES)},
        {"model": "beam", "period": orbits[0].period},
    )


def _events(params: Params, events: Sequence[Event], about: dict[str, str]) -> xr.Dataset:
    """Give what happened on a branch its units."""
    before = [event.before for event in events]
    after = [event.after is not None and event.after.is_stable for event in events]
    gaps = params.initial_gap * np.array([o.gaps for o in before]).reshape(-1, 2)
    multipliers = np.array([abs(o.multipliers[0]) for o in before], float)
    stable_before = np.array([o.is_stable for o in before], bool)
    return xr.Dataset(
        {
            "event_value": ("event", np.array([event.value for event in events], float), about),
            "event_gaps": (("event", "site"), gaps, _named("m", "gap of each site at the event")),
            "event_multiplier": ("event", multipliers, _named("1", "largest multiplier before")),
            "event_stable_before": ("event", stable_before, _named("1", "stable before it")),
            "event_stable_after": ("event", np.array(after, bool), _named("1", "stable after it")),
        },
        {"event": np.array([event.kind for event in events], str)},
    )


def _named(unit: str, meaning: str) -> dict[str, str]:
    return {"units": unit, "long_name": meaning}
