"""Short runs of every propagator, for code that is compiled and for the same in plain Python."""

import json
import sys
from pathlib import Path

import numpy as np

TESTS = Path(__file__).parents[2] / "models"
sys.path += [str(TESTS / name) for name in ("numerics", "beam", "mole", "vibrator")]

import test_dop853  # noqa: E402  (found in the folders above)
import test_lanes  # noqa: E402
import test_mole_exact  # noqa: E402
import test_orbit  # noqa: E402

from models.beam import lanes  # noqa: E402
from models.mole import exact  # noqa: E402
from models.mole.exact import events  # noqa: E402
from models.mole.parameters import Params as Mole  # noqa: E402
from models.vibrator.equations.system import system, systems  # noqa: E402
from models.vibrator.exact import propagator  # noqa: E402
from models.vibrator.lanes.following import follow  # noqa: E402
from models.vibrator.lanes.packed import pack  # noqa: E402
from models.vibrator.parameters import Params as Vibrator  # noqa: E402
from models.vibrator.service.slow_states import spring_breaks  # noqa: E402


def bouncing_ball():
    times = np.empty(4)
    test_dop853.bounces(np.array([0.5, 0.1]), 0.9, 4, 1e-9, times)
    return times


def beam():
    p = test_lanes.nominal(forcing_frequency=57.0)
    prepared = test_lanes.prepared(lanes, p, elements=2, steps_per_period=64)
    state, gaps = test_lanes.at_rest(lanes, prepared)
    record = lanes.advance(prepared, state, gaps, np.full((1, 2), 1e-4), 4)
    assert record.work.max() > 0.1
    return np.concatenate([record.work.ravel(), record.strobe.ravel(), gaps.ravel()])


def mole():
    begun = test_mole_exact.begun(Mole(supply_phase=0.3))
    motion = exact.propagate(*begun, 0.15, 1e-7, [0.03, 0.12])
    return np.concatenate([motion.samples[0], motion.samples[1], motion.state.y])


def vibrator_orbit():
    p = Vibrator._make(field[:1] for field in test_orbit.MACHINES)
    converged, state, period, *others = test_orbit.find(p, 8)
    assert converged.all()
    trace = follow(pack(systems(p).rigid), state, period, 8)
    return np.concatenate([state[0], period, *others, trace[0, 3]])


def vibrator(p, kinematics, **feed):
    machine = system(p, kinematics)._replace(**feed)
    start = propagator.start(p, machine)
    start[len(start) // 2 + 3 : len(start) // 2 + 5] = 150.0
    return propagator.propagate(machine, start, 0.005, 1e-6).state


def vibrator_exact():
    mounted = Vibrator(mount_stiffness=2e7)
    with_feed = vibrator(mounted, "exact", feed_mass=200.0, feed_gravity=9.81)
    in_ramp = vibrator(Vibrator(ramp_time=0.01), "small")
    lagging = vibrator(Vibrator(torque_lag=0.01, support_imbalance=0.3), "small")
    return np.concatenate([vibrator(Vibrator(), "small"), with_feed, in_ramp, lagging])


def vibrator_springs():
    p = Vibrator._make(np.array([value]) for value in Vibrator(spring_life=1e8))
    springs = spring_breaks(p, np.array([2**63 + 5], np.uint64), 3)
    return np.concatenate([*springs.time, *springs.left, *springs.right])


RUNS = (bouncing_ball, beam, mole, vibrator_orbit, vibrator_exact, vibrator_springs)


def compiled_anew():
    """Return how many functions this process has compiled that were to be kept on disk."""
    kept = (test_dop853.bounces, events.run)
    return sum(len(function.stats.cache_misses) for function in kept if hasattr(function, "stats"))


if __name__ == "__main__":
    values = {run.__name__: run().tolist() for run in RUNS}
    print(json.dumps(values | {"compiled anew": compiled_anew()}))
