"""Table 1 and Figures 5 to 8 of Michalczyk & Cieplok 2014, from the vibrator."""

from collections.abc import Iterator
from math import tau
from typing import Any

import numpy as np
from shown import Shown, table

import uq
from models.vibrator.paper.table1 import machines
from models.vibrator.parameters import Settings
from models.vibrator.start import fast
from models.vibrator.theory import averaged
from uq import plots

VARIED = ("damping_ratio", "stiffness_x", "support_offset")
SYMMETRIC = (2, 6)  # rows of the table, from 0: equally stiff supports level with the centre
NOTE = """\
J. Michalczyk, G. Cieplok, *Disturbances in self-synchronisation of vibrators in vibratory
machines*, Archives of Mining Sciences 59 (2014). Signs, many digits and the
individual values of Table 1 are missing from our copy, so the table is compared by its legible
ranges.

Sections 4 and 5 have no legible figure. Of section 4, equations (9) to (11) of a motor set on
elastic mounts are in `tests/support/vibrator_papers.py`, and theory and simulation include the
set on such mounts; individual mounts for each vibrator (4.1) are not modelled. In the paper, equal
elasticity in two perpendicular directions (4.3) does not change the disphasing; in equation (9),
equal mounts along psi and psi + pi/2 cancel exactly, but the simulated machine has a mount along
one direction only, so no simulation confirms this. Of section 5, theory and simulation include a
feed that is thrown and lands without rebound (`studies/vibrator-feed.toml`).
In the paper, disphasing is largest near a throw coefficient of 1.75, small near 2.7 and zero at
2.97. In ours it is largest at 1.71 for a constant weight of the feed and at 1.34 for a constant
mass; at 2.7 it has fallen to 32 or 18 % of that; it changes sign at 2.97 to 2.98."""


def shown() -> Iterator[Shown]:
    """Yield Table 1 and the figures."""
    p = machines()
    found, _ = fast.outcomes(p, Settings())
    yield table_1(p, found)
    for row in range(4):
        yield run_up(p, found, row)


def table_1(p: Any, found: Any) -> Shown:
    """Return Table 1 by theory and by simulation."""
    guess = averaged.disphasing(p)
    rows = [
        (
            f"{i + 1}",
            f"{p.damping_ratio[i]:g}",
            f"{p.stiffness_x[i]:.3g}",
            f"{p.support_offset[i]:g}",
            f"{tidy(guess.angle[i]):.5f}",
            f"{tidy(found.disphasing[i]):.5f}",
            f"{np.degrees(tidy(found.disphasing[i])):.2f}",
            f"{found.angular_amplitude[i] * 1e6:.1f}",
        )
        for i in range(8)
    ]
    head = (
        "row",
        "damping ratio",
        "k_x [N/m]",
        "h [m]",
        "disphasing, theory [rad]",
        "simulated [rad]",
        "simulated [degrees]",
        "rotation of the body [µrad]",
    )
    others = np.delete(np.arange(8), SYMMETRIC)
    angles, turns = np.abs(found.disphasing[others]), found.angular_amplitude[others]
    apart = np.abs(guess.angle - found.disphasing).max()
    return Shown(
        "Table 1: disphasing caused by unequal supports",
        "vibrator-table-1",
        table(head, rows),
        "Nominal machine except for the three columns; from standstill to the periodic orbit.",
        "The paper's angles are between 0.027 and 0.052 rad, with a rotation of a few 1e-5 rad, "
        f"in six rows, and are 0 in rows 3 and 7. Ours are between {angles.min():.3f} and "
        f"{angles.max():.3f} rad, with {turns.min():.1e} to {turns.max():.1e} rad, in the six, "
        f"and within {np.abs(found.disphasing[list(SYMMETRIC)]).max():.0e} rad of 0 in the two. "
        f"Theory and simulation differ by {apart:.0e} rad at most.",
    )


def run_up(p: Any, found: Any, row: int) -> Shown:
    """Draw the start of the machine in one row of Table 1, from 0."""
    given = {name: float(getattr(p, name)[row]) for name in VARIED}
    ds = uq.simulate("vibrator", given)
    figure = plots.history(ds, ["disphasing_angle", "alpha", ["speed_1", "speed_2"]])
    end = float(ds["time"][-1])
    last = ds["trajectory"].sel(time=slice(end - 0.2, None))
    unwrapped = float(last.sel(quantity="disphasing_angle").mean())
    turns = round(unwrapped / tau)
    angle = unwrapped - turns * tau
    turn = float(np.ptp(last.sel(quantity="alpha").values)) / 2
    steady, amplitude = found.disphasing[row], tidy(found.angular_amplitude[row])
    return Shown(
        f"Figure {row + 5}: start-up of the machine in row {row + 1} of Table 1",
        f"vibrator-{row + 5}-row-{row + 1}",
        figure,
        f"Damping ratio {given['damping_ratio']:g}, k_x = {given['stiffness_x']:.3g} N/m, h = "
        f"{given['support_offset']:g} m; both motors switched on at t = 0 from rest, with "
        "both unbalances hanging down.",
        f"In the last 0.2 s of {end:.0f} s the angle, minus {abs(turns)} full turn"
        f"{'s' * (abs(turns) != 1)}, is "
        f"{angle:z.4f} rad "
        f"({steady:z.4f} rad on the periodic orbit) and the body rotates by {turn:.1e} rad "
        f"({amplitude:.2g} rad on the orbit): vibrations on the springs decay with a time constant "
        f"of seconds, so the angle settles within the figure and the rotation does not. The "
        "paper's curves are legible only qualitatively: synchronised at a small constant angle, as "
        "here.",
    )


def tidy(angle: Any) -> float:
    """Return an angle; zero without a sign where only rounding errors are left."""
    return 0.0 if abs(angle) < 5e-7 else float(angle)
