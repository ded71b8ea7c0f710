"""Lives in service against a slow integration: small steps of the exact propagator."""

import numpy as np
import pytest
from service_rods import FIELDS, rows

from models.beam import MODEL, exact
from models.beam.parameters import Params, Settings
from models.beam.response.settling import settle
from models.beam.start import initial_state
from models.beam.structure.modal import beams
from uq.contract import Status

DEPTH, STEP = 5e-5, 0.04  # and relative growth of a gap in a step


def reference(x):
    """Return the earlier time to the depth, by the midpoint rule; flat bars."""
    p = dict(zip(FIELDS, x.T, strict=True))
    q = Params._make(np.ascontiguousarray(x.T))
    settings = Settings(propagator="exact")
    ((group, system),) = exact.groups(beams(q, settings), settings)
    assert (group == np.arange(len(x))).all()
    state = initial_state(exact, system, q)
    factor = 4 / 3 * p["support_width"] * np.sqrt(2 * p["rod_radius"])
    kappa = p["support_wear_ratio"]

    def gaps(volume, t):
        h = (volume / factor[:, None]) ** (2 / 3)
        return (p["initial_gap"] - p["creep_down"] * np.expm1(-t / p["creep_time"]))[:, None] + h

    def rates(volume, t):
        out = settle(exact, system, state, gaps(volume, t) / p["initial_gap"][:, None])
        state[:, 0] += 3e-3  # an orbit that has lost its stability is left
        watt = p["contact_stiffness"] * p["initial_gap"] ** 2 * p["forcing_frequency"]
        return (1 + kappa)[:, None] * p["wear_coefficient"][:, None] * out.work * watt[:, None]

    volume, t = np.zeros((len(x), 2)), np.zeros(len(x))
    goal = factor * ((1 + kappa) * DEPTH) ** 1.5
    life = np.full(len(x), np.nan)
    for _ in range(400):
        rate = rates(volume, t)
        gap = gaps(volume, t)
        wanted = STEP * gap.min(axis=1)
        span = np.full(len(x), 2e4)
        for _ in range(90):
            ahead = gaps(volume + span[:, None] * rate, t + span) - gap
            long = ahead.max(axis=1) > wanted
            span = np.where(long, span * 0.8, span)
        middle = rates(volume + span[:, None] / 2 * rate, t + span / 2)
        grown = volume + span[:, None] * middle
        here, there = volume.max(axis=1), grown.max(axis=1)
        passed = np.isnan(life) & (there >= goal)
        with np.errstate(divide="ignore", invalid="ignore"):
            part = (goal - here) / (there - here)
        life[passed] = (t + part * span)[passed]
        volume, t = grown, t + span
        if np.isfinite(life).all():
            break
    return life


@pytest.mark.slow
def test_lives_with_creep_are_those_of_a_slow_integration():
    n = 8
    rng = np.random.default_rng(5)
    x = rows(n, seed=5, rod_radius=4.75e-3, support_width=0.3, wear_coefficient=1e-13)
    x[:, FIELDS.index("creep_down")] = rng.uniform(0, 1e-4, n)
    x[:, FIELDS.index("creep_time")] = 10 ** rng.uniform(3.3, 4.5, n)
    x[:, FIELDS.index("support_wear_ratio")] = rng.uniform(0, 1, n)
    settings = Settings(scar="flat-bar", depths=(DEPTH,), accuracy=0.02)
    outputs, status = MODEL.batch(x, np.zeros(n, np.uint64), settings)
    assert (status == Status.OK).all()
    life, error = (outputs[f"first_time_to_depth{end}"][:, 0] for end in ("", "_error"))
    expected = reference(x)
    finite = np.isfinite(life) & np.isfinite(expected)
    assert finite.sum() >= 6
    off = np.abs(life - expected)[finite]
    print(np.stack([life, expected, error, outputs["regime"]], axis=1))
    # Steps of the reference and of the fast propagator add 1 %.
    assert (off <= error[finite] + 0.01 * expected[finite]).mean() >= 0.9
