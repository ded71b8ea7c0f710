"""The mole: settled motion and the shipped study compared with other tools at equal error.

Prints the cost of a simulated second in our lanes, by our exact propagator, by heyoka, by
Runge-Kutta steps through the friction's jumps and by scipy. heyoka is optional: it is not
a dependency of the project, and without it its lines are omitted. The error is that of the means of
progression, impact and electrical power, relative to them, and of the state at the end. Each tool
has its cheapest setting that reaches the error, on the same rows; everything on one core, in one
run. Compilation is excluded.
"""

from pathlib import Path

import numpy as np

from benchmarks.compare import Rival, clock, compare
from benchmarks.figures import Figure, keep
from benchmarks.mole_modes import ELECTRIC, IMPACT, JOULE, PROGRESS
from benchmarks.mole_rivals import by_runge_kutta, by_scipy
from models.mole import MODEL, exact
from models.mole.lanes import rows as row_at
from models.mole.lanes.modes import mole_of
from models.mole.lanes.rows import SCALES
from models.mole.parameters import Params, Settings
from models.mole.response.machines import Machines
from models.mole.theory.equations import ELECTRICAL_WORK, IMPACT_WORK, MOLE_DISPLACEMENT, SIZE
from uq.study.definition import load_study
from uq.study.row_sampling import row_block

try:
    from benchmarks.mole_taylor import Taylor
except ModuleNotFoundError as missing:
    if missing.name != "heyoka":
        raise
    Taylor = None

FREQUENCIES = 5.0, 7.0, 8.0  # [Hz]
SCATTERED = "bar_friction", "mole_friction", "contact_stiffness", "spring_stiffness", "resistance"
ROWS, KNOWN = 256, 8  # in all; with a reference
SETTLING, DURATION = 60.0, 10.0  # [s]
STUDY, STUDIED = Path(__file__).parent.parent / "studies" / "mole-progression.toml", 1000
CORES = 2


def settled(frequency):
    """Return moles, slightly scattered, after a minute."""
    rng = np.random.default_rng(1)
    fields = {name: np.full(ROWS, float(value)) for name, value in Params._field_defaults.items()}
    for name in SCATTERED:
        fields[name] *= 1 + 0.01 * rng.uniform(-1, 1, ROWS)
    p = Params(**fields | {"control_frequency": np.full(ROWS, frequency)})
    machines = Machines.started(p, Settings(tolerance=1e-9))
    machines.run(np.arange(ROWS), np.full(ROWS, round(SETTLING * frequency)))
    return machines


class Stretch:
    """Ten seconds of settled motion, by each tool.

    Results have shape (n, 6): mean progression [m/s], impact and electrical power [W]; u, v, x.
    """

    def __init__(self, frequency):
        self.machines = settled(frequency)
        self.halves = round(2 * DURATION * frequency)
        self.made = {}

    def by_lanes(self, rows, tolerance):
        """Run in lanes."""
        system = self.machines.system.take(np.arange(rows))._replace(tolerance=tolerance)
        machines = Machines(system, self.machines.record[:rows].copy())
        machines.run(np.arange(rows), machines.periods(np.arange(rows)) + self.halves // 2)
        first, last = row_at.PROGRESS, row_at.ELECTRIC + 1
        return np.hstack([machines.record[:, first:last] / DURATION, machines.record[:, :3]])

    def by_exact(self, rows, tolerance):
        """Run from event to event by the exact propagator."""
        table, record = self.machines.system.table, self.machines.record
        means = [MOLE_DISPLACEMENT, IMPACT_WORK, ELECTRICAL_WORK]
        results = []
        for row in range(rows):
            q, half = mole_of(table, row), int(record[row, row_at.HALF])
            y = np.zeros(SIZE)
            y[: row_at.BAR_MODE] = record[row, : row_at.BAR_MODE]
            bar, slip, touching = record[row, row_at.BAR_MODE : row_at.HALF]
            time, end = 0.5 * q.control_period * half, 0.5 * q.control_period * (half + self.halves)
            start = exact.State(time, y, touching, bar, slip, half + 1)
            end = exact.propagate(q, start, end, tolerance).state.y
            results.append([*end[means] / DURATION, *end[:3]])
        return np.array(results)

    def by_taylor(self, batch):
        """Return a function that runs with so many machines side by side."""

        def run(rows, tolerance):
            if (batch, tolerance) not in self.made:
                self.made[batch, tolerance] = Taylor(batch, tolerance)
            taylor = self.made[batch, tolerance]
            return _results(taylor.advance(*self._some(rows), self.halves))

        return run

    def by_scipy(self, rows, tolerance):
        """Run from event to event by scipy."""
        return _results(by_scipy(*self._some(rows), self.halves, tolerance))

    def by_runge_kutta(self, rows, steps):
        """Run through the events with so many steps in half a control period."""
        end = by_runge_kutta(*self._some(rows), self.halves, steps)
        return np.hstack([end[5:].T / DURATION, end[:3].T])

    def _some(self, rows):
        return self.machines.system.table[:rows], self.machines.record[:rows]


def _results(end):
    means = [end[PROGRESS], end[IMPACT] / JOULE, end[ELECTRIC] / JOULE]
    return np.hstack([np.transpose(means) / DURATION, end[:3].T])


PEERS = {
    "heyoka, batches of 8, tolerance": "heyoka with events, in batches of 8",
    "scipy DOP853, compiled, rtol": "scipy's DOP853 with events and compiled rates",
    "Runge-Kutta, signum, steps": "Runge-Kutta steps through the jumps",
}


def settled_motion(frequency):
    stretch = Stretch(frequency)
    reference = stretch.by_exact(KNOWN, 1e-13)
    scales = np.hstack([np.abs(reference[:, :3]), np.tile(SCALES, (KNOWN, 1))])

    def error_of(results):
        return (np.abs(results - reference[: len(results)]) / scales[: len(results)]).max()

    tolerances = 10.0 ** -np.arange(3, 13, 0.5)
    rivals = {
        "lanes, tolerance": Rival(stretch.by_lanes, tolerances[2:], ROWS),
        "exact propagator, tolerance": Rival(stretch.by_exact, tolerances[2:], KNOWN),
    }
    if Taylor is not None:
        for batch, rows in (8, ROWS // 4), (1, KNOWN):
            run = stretch.by_taylor(batch)
            rivals[f"heyoka, batches of {batch}, tolerance"] = Rival(run, tolerances, rows)
    rivals["scipy DOP853, compiled, rtol"] = Rival(stretch.by_scipy, tolerances[6::2], 1)
    steps = [round(100 * 1.5**k) for k in range(20)]
    jumps = {"Runge-Kutta, signum, steps": Rival(stretch.by_runge_kutta, steps, KNOWN)}
    print(f" {frequency:g} Hz")
    figures = []
    for tools, goal in ((rivals | jumps, 1e-3), (rivals, 1e-6)):
        task = f"settled motion of the mole at {frequency:g} Hz, to {goal:.0e}"
        ratios = compare(tools, error_of, KNOWN, goal, amount=DURATION)
        figures += [Figure(task, PEERS[name], ratios[name]) for name in ratios if name in PEERS]
    return figures


def study():
    progression = load_study(STUDY, "models.mole:MODEL")
    blocks = [
        row_block(progression, first, min(first + MODEL.block, STUDIED))
        for first in range(0, STUDIED, MODEL.block)
    ]
    settings, rows = progression.settings, progression.design.samples
    MODEL.batch(blocks[0].x[:16], blocks[0].seed[:16], settings)
    _, seconds = clock(lambda: [MODEL.batch(b.x, b.seed, settings) for b in blocks], repeat=1)
    print(f"Shipped study: {STUDIED / seconds:.0f} rows per second and core")
    forecast = rows * seconds / STUDIED / CORES
    print(f"  its {rows} rows on {CORES} cores: {forecast:.0f} s")


if __name__ == "__main__":
    if Taylor is None:
        print("heyoka is not installed and omitted")
    print("Settled motion: setting, error, time per simulated second, ratio")
    keep("mole", [figure for hertz in FREQUENCIES for figure in settled_motion(hertz)])
    study()
