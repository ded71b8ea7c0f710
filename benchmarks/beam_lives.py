"""The beam's lives: cost of a row, by regime, and coverage of the stated errors.

Rows of the shipped lifetime studies, to a depth of one initial gap: core-milliseconds per row,
then their lives compared with those at a tenth of the accuracy. Regimes during wear are identified
from drifting stroboscopic points; here they are compared with those of the same states settled at
gaps that no longer wear.
"""

import time
from itertools import count
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from models.beam import MODEL, lanes
from models.beam.parameters import REGIMES, Params, Settings
from models.beam.response.settling import settle
from models.beam.start import initial_gaps
from models.beam.structure.modal import beams
from models.beam.wear.regimes import changes_of, confirmed_regimes
from models.beam.wear.worn_beams import wear_down
from models.numerics.blocks import LANES
from uq.study.definition import load_study
from uq.study.row_sampling import row_block

STUDIES = Path(__file__).parent.parent / "studies"
CASES = (("beam-lifetime-561", 0.02), ("beam-lifetime-561", 0.04), ("beam-lifetime", 0.01))
CASES += (("beam-lifetime", 0.05),)
DEPTHS = (2.5e-4,)
ROWS, CHECKED, SETTLED = 256, 50, 40
EVERY = 4  # rounds


def rows_of(name, begin, end):
    study = load_study(STUDIES / f"{name}.toml")
    return row_block(study, begin, end)


def lives(rows, accuracy):
    settings = Settings(depths=DEPTHS, accuracy=accuracy)
    began = time.process_time()
    outputs, _ = MODEL.batch(rows.x, rows.seed, settings)
    return outputs, (time.process_time() - began) / len(rows.x) * 1e3


def costs(name, accuracy):
    rows = rows_of(name, 0, ROWS)
    outputs, each = lives(rows, accuracy)
    print(f"{name}, accuracy {accuracy}: {each:.2f} core-ms per row")
    for code, regime in enumerate(REGIMES):
        mine = np.flatnonzero(outputs["regime"] == code)
        if len(mine) >= LANES:
            part = SimpleNamespace(x=rows.x[mine], seed=rows.seed[mine])
            print(f"    {regime:20s} {len(mine):4d} rows {lives(part, accuracy)[1]:8.2f}")


def errors(name, accuracy):
    rows = rows_of(name, ROWS, ROWS + CHECKED)
    reference = lives(rows, accuracy / 10)[0]
    computed = lives(rows, accuracy)[0]
    life = reference["first_time_to_depth"][:, 0]
    off = np.abs(computed["first_time_to_depth"][:, 0] / life - 1)
    stated = computed["first_time_to_depth_error"][:, 0] / life
    same = np.mean(computed["regime_changes"] == reference["regime_changes"])
    print(
        f"    error: median {np.median(off):.2%}, ninth decile {np.quantile(off, 0.9):.2%}; stated "
        f"{np.median(stated):.2%}; beyond it {np.mean(off > stated):.0%}, beyond twice "
        f"{np.mean(off > 2 * stated):.0%}; as many changes of regime {same:.0%}"
    )


def regimes(name, periods=4096):
    rows = rows_of(name, ROWS + CHECKED, ROWS + CHECKED + SETTLED)
    p = Params._make(np.ascontiguousarray(rows.x.T))
    settings = Settings(depths=DEPTHS)
    looks = alike = counts = close = 0
    for chosen, system in lanes.groups(beams(p, settings), settings):
        q = Params._make(field[chosen] for field in p)
        gaps, x0 = initial_gaps(q), q.initial_gap
        state = lanes.start(system, q.initial_displacement / x0, q.initial_velocity / x0)
        settled = settle(lanes, system, state, gaps)
        seen, rounds = [], count()

        def advance(system, state, gaps, growth, periods, seen=seen, rounds=rounds):
            record = lanes.advance(system, state, gaps, growth, periods)
            if next(rounds) % EVERY == 0:
                regime = settle(lanes, system, state.copy(), gaps.copy()).regime
                seen.append((system.beams.stiffness, gaps.copy(), regime))
            return record

        share = np.stack([np.ones_like(x0), q.wear_coefficient_ratio], axis=1)
        growths = np.asarray(DEPTHS) / x0[:, None]
        spy = SimpleNamespace(advance=advance, CLOCK=lanes.CLOCK)
        start = (spy, system, state, gaps, settled.work, settled.regime)
        life = wear_down(*start, share, growths, periods, settings.accuracy).history
        row, at, regime = (np.concatenate(arrays) for arrays in zip(*seen, strict=True))
        truth = np.full_like(life.regime, -1)
        for i, k in enumerate(system.beams.stiffness):  # no two rows have the same
            mine = np.flatnonzero(row == k)
            for look in np.flatnonzero(life.regime[i] >= 0):
                apart = np.abs(at[mine] - life.gaps[i, look]).max(axis=1)
                truth[i, look] = regime[mine[apart.argmin()]]
        looks += (life.regime >= 0).sum()
        alike += ((life.regime == truth) & (truth >= 0)).sum()
        changes, true_changes = (
            changes_of(confirmed_regimes(r)).sum(axis=1) for r in (life.regime, truth)
        )
        counts += (changes == true_changes).sum()
        close += (np.abs(changes - true_changes) <= 1).sum()
    print(
        f"{name}, regimes at frozen gaps: {alike / looks:.1%} of {looks} looks alike; as many "
        f"changes in {counts} of {SETTLED} lives, one more or less in {close - counts}"
    )


if __name__ == "__main__":
    lives(rows_of("beam-lifetime", 0, 32), 1.0)  # compiles
    for name, accuracy in CASES:
        costs(name, accuracy)
        errors(name, accuracy)
    for name in ("beam-lifetime-561", "beam-lifetime"):
        regimes(name)
