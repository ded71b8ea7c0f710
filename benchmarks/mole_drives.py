"""Times to a distance beside small steps along the way by the event-driven propagator.

    python -m benchmarks.mole_drives [ROWS] [SEED]

At each of `PLACES` the mole of the propagator drives on from its state at the place before, on the
ground of the new place, and its velocity is the mean over whole seconds, in which supply and relay
repeat. Its own error is 1.645 standard errors of the time, from batches of a second.
"""

import math
import sys
import time
from typing import Any

import numpy as np

from models.mole import MODEL, exact
from models.mole.parameters import Params, Settings
from models.mole.theory import equations
from models.mole.theory.system import mole

DISTANCE, PLACES = 2.0, 17
SETTLING, SECONDS = 8, 24  # [s]
SURE = 1.6449


def drawn(rows: int, seed: int) -> Any:
    """Return moles at 5, 7 and 8 Hz on ground that grows rougher, shape (rows, d)."""
    rng = np.random.default_rng(seed)
    x = np.tile(np.array(Params(), float), (rows, 1))
    values = {
        "control_frequency": rng.choice([5.0, 7.0, 8.0], rows),
        "mole_friction": rng.uniform(0.2, 0.27, rows),
        "friction_gradient": rng.uniform(0.0, 0.1, rows),
        "bar_friction": rng.uniform(0.25, 0.34, rows),
        "resistance": rng.uniform(24.75, 30.25, rows),
    }
    for name, column in values.items():
        x[:, Params._fields.index(name)] = column
    return x


def small_steps(row: Any) -> tuple[float, float]:
    """Return the time to the distance [s] and its error; infinite where the mole stands still."""
    p = Params(*row.tolist())
    state = exact.start(p, mole(p, "physical"))
    places = np.linspace(0.0, DISTANCE, PLACES)
    speed, error = np.empty((2, PLACES))
    for k, place in enumerate(places.tolist()):
        rough = p.mole_friction + p.friction_gradient * place
        q = mole(p._replace(mole_friction=rough), "physical")
        settled = exact.propagate(q, state, state.time + SETTLING, 1e-9).state
        times = settled.time + np.arange(SECONDS + 1.0)
        motion = exact.propagate(q, settled, float(times[-1]), 1e-9, times)
        way = motion.samples[:, equations.MOLE_DISPLACEMENT]
        speed[k] = (way[-1] - way[0]) / SECONDS
        error[k] = np.diff(way).reshape(-1, 3).mean(axis=1).std(ddof=1) / math.sqrt(SECONDS / 3)
        state = motion.state
    if not (speed > 0).all():
        return math.inf, math.nan
    weights = np.full(PLACES, DISTANCE / (PLACES - 1))
    weights[[0, -1]] /= 2
    spread = weights * error / speed**2
    bend = np.trapezoid(1 / speed[::2], places[::2]) - np.trapezoid(1 / speed, places)
    return float((weights / speed).sum() - bend / 3), SURE * float(np.sqrt((spread**2).sum()))


def main() -> None:
    """Print each mole, and how many are within the errors."""
    rows, seed = (*map(int, sys.argv[1:]), *(30, 1)[len(sys.argv) - 1 :])
    x = drawn(rows, seed)
    outputs = MODEL.batch(x, np.zeros(rows, np.uint64), Settings(distance=(DISTANCE,)))[0]
    begin, within, alone = time.process_time(), 0, 0
    print("   T [s]      stated    small steps   error    off/stated  off/both")
    for i in range(rows):
        life, stated = (outputs[f"time_to_distance{end}"][i, 0] for end in ("", "_error"))
        reference, error = small_steps(x[i])
        if math.isinf(life) or math.isinf(reference):
            within, alone = within + (life == reference), alone + (life == reference)
            print(f"{life:10.5g} {reference:20.5g}")
            continue
        off = abs(life - reference)
        within, alone = within + (off <= math.hypot(stated, error)), alone + (off <= stated)
        both = off / math.hypot(stated, error)
        print(f"{life:10.5g} {stated:10.2g} {reference:12.5g} {error:10.2g}", end=" ")
        print(f"{off / stated:10.2f} {both:9.2f}")
    print(f"{alone} of {rows} within the stated errors, {within} within those of both")
    print(f"{(time.process_time() - begin) / rows:.2f} s a mole by small steps")


if __name__ == "__main__":
    main()
