"""The beam: effect of mesh and modes on work-rate and life, against 40 elements with all modes.

Prints, for the paper's two cases, the error of the heavier site's work-rate and of the life to
twice the gap, and the cost: microseconds per forcing period and row, milliseconds per row for the
modes, and for response and life together. Elements and modes are part of the model: this shows how
much models differ, not how accurately one of them is solved. Everything on one core.
"""

import numpy as np

from benchmarks.beam import KNOWN, clock, nominal
from models.beam import lanes
from models.beam.batch import simulate_rows
from models.beam.parameters import Settings
from models.beam.structure.modal import beams

ROWS, PERIODS = 16, 200
REFERENCE = {"elements": 40}
MESHES = (
    {"elements": 20},
    {"elements": 10},
    {"elements": 10, "modes": 8},
    {"elements": 10, "modes": 8, "residual_flexibility": True},
    {"elements": 40, "modes": 12, "residual_flexibility": True},
    {"elements": 40, "modes": 8, "residual_flexibility": True},
    {"elements": 40, "modes": 6, "residual_flexibility": True},
)


def measure(frequency, mesh):
    """Return work-rate, life, and seconds: per period, for the modes, in all; each of a row."""
    rng = np.random.default_rng(1)
    p = nominal(frequency, ROWS)
    p = p._replace(contact_stiffness=p.contact_stiffness * (1 + 1e-6 * rng.random(ROWS)))
    settings = Settings(depths=(2.5e-4,), accuracy=0.01, **mesh)
    b, preparing = clock(lambda: beams(p, settings))
    ((_, system),) = lanes.groups(b, settings)
    state, gaps = lanes.start(system, np.zeros(ROWS), np.zeros(ROWS)), np.ones((ROWS, 2))
    still = np.zeros((ROWS, 2))
    _, stepping = clock(lambda: lanes.advance(system, state, gaps, still, PERIODS))
    simulated, whole = clock(lambda: simulate_rows(p, settings), repeat=1)
    work = np.median(simulated.response.work.max(axis=1))
    life = np.median(simulated.lives.time[:, 2, 0])
    return work, life, stepping / ROWS / PERIODS, preparing / ROWS, whole / ROWS


def main():
    for frequency in KNOWN:
        print(f"{frequency} Hz            work-rate      life   us/period   ms: modes     all")
        known_work, known_life, *seconds = measure(frequency, REFERENCE)
        _report(REFERENCE, 0.0, 0.0, *seconds)
        for mesh in MESHES:
            work, life, *seconds = measure(frequency, mesh)
            _report(mesh, work / known_work - 1, life / known_life - 1, *seconds)


def _report(mesh, work, life, stepping, preparing, whole):
    modes = str(mesh.get("modes", "all")) + (" + rest" if "residual_flexibility" in mesh else "")
    print(
        f"  {mesh['elements']:2d} elements, {modes:10s}{work:+10.2%}{life:+10.2%}"
        f"{stepping * 1e6:12.2f}{preparing * 1e3:12.2f}{whole * 1e3:8.2f}"
    )


if __name__ == "__main__":
    main()
