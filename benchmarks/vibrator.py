"""The vibrator: run-ups and steady states compared with other tools at equal error.

Prints the cost of a start from standstill in our lanes, by scipy, by our exact propagator and by
heyoka, which is optional: it is not a dependency of the project, and without it its lines are
omitted. Then the steady state against shooting, one machine at a time; the rows of the shipped
study; and the averaged theory. Each tool has its cheapest setting that reaches the error, on the
same rows; everything on one core, in one run. Compilation is excluded, and so is the setup of
heyoka and shooting.
"""

from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.compare import Rival, clock, compare
from benchmarks.figures import Figure, keep
from benchmarks.shooting import rates, shoot
from models.numerics.blocks import LANES
from models.vibrator import MODEL, lanes
from models.vibrator.equations import rigid_motion
from models.vibrator.equations.system import systems
from models.vibrator.exact import orbit, propagator
from models.vibrator.exact.budgeted import prepare
from models.vibrator.lanes.machines import prepared
from models.vibrator.lanes.packed import pack
from models.vibrator.parameters import Params
from models.vibrator.start.synchronous import propose
from models.vibrator.theory import averaged
from uq.study.definition import load_study
from uq.study.row_sampling import row_block

try:
    from benchmarks.taylor import Taylor
except ModuleNotFoundError as missing:
    if missing.name != "heyoka":
        raise
    Taylor = None

ROWS, KNOWN, ONE_BY_ONE = 512, 16, 4  # in all; with a reference; timed where one row takes long
DURATION = 5.0  # [s]
STUDY = Path(__file__).parent.parent / "studies" / "vibrator-tolerances.toml"


def scattered(n):
    """Return nominal machines whose springs, motors and geometry scatter a little."""
    rng = np.random.default_rng(1)
    fields = {name: np.full(n, float(value)) for name, value in Params._field_defaults.items()}
    for name in ("stiffness_x", "stiffness_y", "rated_torque_1", "rated_torque_2", "unbalance_1"):
        fields[name] *= 1 + 0.01 * rng.uniform(-1, 1, n)
    fields["axis_offset"] += 0.005 * rng.uniform(-1, 1, n)
    return Params(**fields)


P = scattered(ROWS)
SYSTEM = systems(P)
START = rigid_motion.initial_state(P)
CONSTANTS = np.repeat(pack(SYSTEM.rigid), LANES, axis=1)  # of each row, in all lanes


def angle_of(states):
    return states[:, 3] - states[:, 4]


def by_scipy(rows, tolerance):
    ends = []
    for i in range(rows):
        c, scales = CONSTANTS[i], propagator.scales_of(SYSTEM.row(i), rigid_motion.DEGREES)
        run = solve_ivp(
            rates,
            (0.0, DURATION),
            START[i],
            "DOP853",
            [DURATION],
            args=(c,),
            rtol=tolerance,
            atol=tolerance * scales,
        )
        ends.append(run.y[:, -1])
    return np.array(ends)


def by_exact(rows, tolerance):
    runs = (propagator.propagate(SYSTEM.row(i), START[i], DURATION, tolerance) for i in range(rows))
    return np.array([run.state for run in runs])


def by_lanes(rows, steps):
    """Return the states at the end, with all that has to be set up."""
    p = Params._make(field[:rows] for field in P)
    machines, nowhere = prepared(p), np.full(rows, np.nan)
    state = lanes.start(machines)
    lanes.advance(machines, state, np.full(rows, DURATION / steps), nowhere, steps, 0.0, True)
    return state


def beside(rivals, reference, goal):
    """Compare tools by the largest error of the angles [rad] of the first rows."""
    return compare(
        rivals,
        lambda angles: np.abs(angles - reference[: len(angles)]).max(),
        len(reference),
        goal,
        " rad",
    )


PEERS = {
    "scipy DOP853, compiled, rtol": "scipy's DOP853 with compiled rates",
    "heyoka, batches of 8, tolerance": "heyoka in batches of 8",
    "shooting, steps a turn": "shooting, one machine at a time",
}


def figures(task, ratios):
    """Return the figures of the first tool against its peers."""
    return [Figure(task, PEERS[name], ratio) for name, ratio in ratios.items() if name in PEERS]


def run_ups():
    print(f"Run-up of {DURATION:g} s: setting, error, time per row, ratio")
    reference = angle_of(by_scipy(KNOWN, 1e-12))
    tolerances = 10.0 ** -np.arange(2, 13, 0.5)
    rivals = {
        "lanes, steps": Rival(
            lambda n, steps: angle_of(by_lanes(n, steps)),
            [round(150 * 1.05**k) for k in range(90)],
            ROWS,
        ),
        "exact propagator, tolerance": Rival(
            lambda n, tolerance: angle_of(by_exact(n, tolerance)),
            tolerances,
            KNOWN,
        ),
        "scipy DOP853, compiled, rtol": Rival(
            lambda n, tolerance: angle_of(by_scipy(n, tolerance)),
            tolerances,
            ONE_BY_ONE,
        ),
    }
    if Taylor is None:
        print("  heyoka is not installed and omitted")
    else:
        made = {}

        def by_taylor(n, tolerance):
            if tolerance not in made:
                made[tolerance] = Taylor(SYSTEM.rigid, tolerance)
            return angle_of(made[tolerance].advance(START[:n], DURATION))

        rivals["heyoka, batches of 8, tolerance"] = Rival(by_taylor, tolerances, ROWS)
    collected = []
    for goal in (1e-4, 1e-8):
        task = f"run-up of the vibrator, angle to {goal:.0e} rad"
        collected += figures(task, beside(rivals, reference, goal))
    return collected


def steady_states():
    print("Steady state: setting, error, time per row, ratio")
    budget = 10**9  # steps
    ones = [
        prepare(Params._make(float(field[i]) for field in P), "small", budget) for i in range(KNOWN)
    ]
    guesses = [orbit.proposal(machine) for machine in ones]
    orbits = [
        orbit.find_orbit(machine, guess, 1e-12)
        for machine, guess in zip(ones, guesses, strict=True)
    ]
    reference = np.array([solution.measures.disphasing for solution in orbits])

    def by_shooting(n, steps):
        return np.array(
            [
                shoot(CONSTANTS[i], guesses[i], 2 * np.pi / guesses[i][8], ones[i].scales, steps)
                for i in range(n)
            ]
        )

    def by_theory_and_newton(n, steps):
        p = Params._make(field[:n] for field in P)
        return propose(prepared(p), steps).disphasing

    rivals = {
        "lanes, steps a turn": Rival(by_theory_and_newton, (24, 36, 48, 72, 96), ROWS),
        "shooting, steps a turn": Rival(
            by_shooting, [round(16 * 1.1**k) for k in range(60)], KNOWN
        ),
    }
    task = "steady state of the vibrator, angle to 1e-08 rad"
    return figures(task, beside(rivals, reference, 1e-8))


def study():
    tolerances = load_study(STUDY)
    rows = row_block(tolerances, 0, ROWS)
    (outputs, _), seconds = clock(lambda: MODEL.batch(rows.x, rows.seed, tolerances.settings))
    print(f"Shipped study: {ROWS / seconds:.0f} rows per second and core")
    pair = np.stack([outputs["disphasing_angle"], outputs["theory_disphasing_angle"]])
    pair = pair[:, np.isfinite(pair).all(axis=0)]
    rest = 1 - np.corrcoef(pair)[0, 1] ** 2
    print(
        f"  {pair.shape[1]} rows locked: correlation of theory and simulation 1 - {rest / 2:.1e},"
        f" variance left by the theory as a control variate {rest:.1e}"
    )


def averaged_theory():
    n = 8 * ROWS
    p = scattered(n)
    _, seconds = clock(lambda: averaged.disphasing(p))
    print(f"Averaged theory: {n / seconds:.3g} machines per second")


if __name__ == "__main__":
    keep("vibrator", run_ups() + steady_states())
    study()
    averaged_theory()
