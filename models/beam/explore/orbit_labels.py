"""Units and names of periodic orbits along a branch, and of the events between them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from models.beam.branches.bifurcations import Event
from models.beam.branches.orbits import Orbit
from models.beam.exact.tuning import Tuning
from models.beam.parameters import SITES, Params
from models.beam.structure.modal import Array
from models.beam.units import joule, newton


def labelled_orbits(
    params: Params, tuning: Tuning, orbits: Sequence[Orbit], frequency: Array
) -> xr.Dataset:
    """Return the orbits of a branch with their units."""
    x0 = params.initial_gap
    work = np.array([orbit.work for orbit in orbits])
    impacts = np.full((len(orbits), max(len(o.impact_velocities) for o in orbits)), np.nan)
    for row, orbit in zip(impacts, orbits, strict=True):
        row[: len(orbit.impact_velocities)] = orbit.impact_velocities
    multipliers = np.array([orbit.multipliers for orbit in orbits])
    f = frequency[:, None]
    sited, multiplied = ("point", "site"), ("point", "multiplier")
    variables: dict[str, tuple[Any, Array, str, str]] = {
        "gaps": (sited, x0 * np.array([o.gaps for o in orbits]), "m", "gap of each site"),
        "work_rate": (sited, joule(params) * f * work, "W", "impact work-rate of each site"),
        "dimensionless_work_rate": (
            sited,
            f / tuning.fundamental * work,
            "1",
            "impact work-rate of each site over k_c X0^2 w0",
        ),
        "peak_contact_force": (
            sited,
            newton(params) * np.array([o.peak for o in orbits]),
            "N",
            "largest contact force of each site",
        ),
        "impact_velocity": (
            ("point", "impact"),
            x0 * 2 * np.pi * f * impacts,
            "m s-1",
            "tip velocity at impact on the right stop",
        ),
        "multiplier_real": (multiplied, multipliers.real, "1", "real part of the multipliers"),
        "multiplier_imag": (multiplied, multipliers.imag, "1", "imaginary part of the multipliers"),
        "stable": ("point", np.array([o.is_stable for o in orbits]), "1", "whether stable"),
        "clearance": (
            "point",
            x0 * np.array([o.clearance for o in orbits]),
            "m",
            "smallest distance from a stop's face at which the tip turns",
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
            name: (dims, values, named(unit, meaning))
            for name, (dims, values, unit, meaning) in variables.items()
        },
        {"site": list(SITES)},
        {"model": "beam", "period": orbits[0].period},
    )


def labelled_events(params: Params, events: Sequence[Event], about: dict[str, str]) -> xr.Dataset:
    """Return the events on a branch with their units."""
    before = [event.before for event in events]
    after = [event.after is not None and event.after.is_stable for event in events]
    gaps = params.initial_gap * np.array([o.gaps for o in before]).reshape(-1, 2)
    multipliers = np.array([abs(o.multipliers[0]) for o in before], float)
    stable_before = np.array([o.is_stable for o in before], bool)
    return xr.Dataset(
        {
            "event_value": ("event", np.array([event.value for event in events], float), about),
            "event_gaps": (("event", "site"), gaps, named("m", "gap of each site at the event")),
            "event_multiplier": ("event", multipliers, named("1", "largest multiplier before it")),
            "event_stable_before": ("event", stable_before, named("1", "stable before it")),
            "event_stable_after": ("event", np.array(after, bool), named("1", "stable after it")),
        },
        {"event": np.array([event.kind for event in events], str)},
    )


def named(unit: str, meaning: str) -> dict[str, str]:
    """Return the attributes of a labelled variable."""
    return {"units": unit, "long_name": meaning}
