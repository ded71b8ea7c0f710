"""Lives of rods in service against a slow integration that shares only the equations of motion.

Rods with scattered inputs and frequencies, whose gaps creep open while a flat bar and the rod wear
each other. The reference moves the gaps in small steps of the midpoint rule and follows each rod
with the exact propagator, without a search for orbits: every work-rate is a plain mean over periods
after others that are left out. Half the steps show the error of the reference itself.
"""

import argparse
from pathlib import Path
from typing import NamedTuple

import numpy as np

from models.beam import MODEL, exact
from models.beam.parameters import REGIMES, Params, Settings
from models.beam.start import initial_state
from models.beam.structure.modal import beams
from models.beam.units import watt
from uq.study.definition import load_study
from uq.study.row_sampling import row_block

STUDY = Path(__file__).parent.parent / "studies" / "beam-lifetime.toml"
ROWS = 30
DEPTHS = (5e-5, 1e-4)
ACCURACY = 0.02
STEPS = (0.04, 0.02)  # largest change of a gap, relative to it
OMEGA = 3.0, 11.0
FIRST = 36.24 / (2 * np.pi)  # Hz, natural frequency of the nominal rod
LEFT_OUT, AVERAGED = 240, 480  # forcing periods; 240 is a multiple of nearly all up to 16
AT_FIRST = 960
PUSH = 1e-6  # of the tip [X0], to leave an orbit that has lost its stability
LONGEST = 30.0  # lives, as estimated by the linear theory


class Lives(NamedTuple):
    """First times to depth [s], and their errors, each of shape (n, D)."""

    time: np.ndarray
    error: np.ndarray


def draw(n, seed):
    """Return n rows; creep goes on about as long as the life."""
    rng = np.random.default_rng(seed)
    x = row_block(load_study(STUDY), 0, n).x.copy()
    at = Params._fields.index
    x[:, at("forcing_frequency")] = rng.uniform(*OMEGA, n) * FIRST
    x[:, at("support_wear_ratio")] = rng.uniform(0, 1, n)
    settings = Settings(scar="flat-bar", depths=DEPTHS, horizon=1.0)
    outputs, _ = MODEL.batch(x, np.zeros(n, np.uint64), settings)
    linear = outputs["linear_time_to_depth"][:, 0]
    x[:, at("creep_down")] = rng.uniform(0, 1e-4, n)
    x[:, at("creep_time")] = np.clip(linear * 10 ** rng.uniform(-0.7, 0.7, n), 1e3, 1e12)
    return x, np.where(np.isfinite(linear), linear, 1e12)


def slow_life(row, step, longest):
    """Return the first times to depth of one rod, shape (D,); inf if not by `longest`."""
    q = Params._make(row[:, None])
    p = Params._make(row)
    ((_, system),) = exact.groups(beams(q, Settings()), Settings())
    state = initial_state(exact, system, q)
    factor = 4 / 3 * p.support_width * np.sqrt(2 * p.rod_radius)
    kappa = p.support_wear_ratio
    new = p.initial_gap * (1 + p.gap_asymmetry / 2 * np.array([1.0, -1.0]))
    joules = (1 + kappa) * p.wear_coefficient * watt(p)

    def gaps(volume, t):
        return new - p.creep_down * np.expm1(-t / p.creep_time) + (volume / factor) ** (2 / 3)

    def follow(at, periods):
        place, still = at[None] / p.initial_gap, np.zeros((1, 2))
        return exact.advance(system, state, place, still, periods).work[0].mean(axis=0)

    def rate(volume, t):
        state[0, 0] += PUSH
        follow(gaps(volume, t), LEFT_OUT)
        return joules * follow(gaps(volume, t), AVERAGED)

    goals = factor * ((1 + kappa) * np.array(DEPTHS)) ** 1.5
    life = np.full(len(goals), np.inf)
    volume, t, span = np.zeros(2), 0.0, longest
    follow(gaps(volume, t), AT_FIRST)
    while t < longest and np.isinf(life).any():
        gap, begins = gaps(volume, t), rate(volume, t)
        span *= 2
        while (gaps(volume + span * begins, t + span) - gap > step * gap).any():
            span *= 0.9
        grown = volume + span * rate(volume + span / 2 * begins, t + span / 2)
        here, there = volume.max(), grown.max()
        passed = np.isinf(life) & (there >= goals)
        life[passed] = t + span * (goals[passed] - here) / (there - here)
        volume, t = grown, t + span
    return life


def computed(x):
    settings = Settings(scar="flat-bar", depths=DEPTHS, accuracy=ACCURACY)
    outputs, _ = MODEL.batch(x, np.zeros(len(x), np.uint64), settings)
    lives = Lives(*(outputs[f"first_time_to_depth{end}"] for end in ("", "_error")))
    return lives, outputs["regime"], outputs["regime_changes"]


def compare(n, seed):
    x, linear = draw(n, seed)
    lives, regime, changes = computed(x)
    omega = x[:, Params._fields.index("forcing_frequency")] / FIRST
    print(
        "row omega regime               changes  depth  life [s]  stated reference its error    off"
    )
    within, count = 0, 0
    for i in range(n):
        if not linear[i] < 1e12:
            continue
        coarse, fine = (slow_life(x[i], step, LONGEST * linear[i]) for step in STEPS)
        for j, depth in enumerate(DEPTHS):
            life, error = lives.time[i, j], np.nan_to_num(lives.error[i, j])
            both = np.isinf(life) and np.isinf(fine[j])
            doubt = 0.0 if both else abs(coarse[j] - fine[j])
            off = 0.0 if both else abs(life - fine[j])
            count += 1
            within += off <= error + doubt
            part = 0.0 if both else (life - fine[j]) / fine[j]
            print(
                f"{i:3d} {omega[i]:5.2f} {REGIMES[regime[i]]:20s} {changes[i]:7.0f} {depth:6.0e} "
                f"{life:9.4g} {error / fine[j]:7.2%} {fine[j]:9.4g} {doubt / fine[j]:9.2%} "
                f"{part:+7.2%}{'' if off <= error + doubt else '  beyond'}",
                flush=True,
            )
    print(f"{within} of {count} lives are within the sum of the stated and the reference's error")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=int, default=ROWS)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    compare(chosen.rows, chosen.seed)
