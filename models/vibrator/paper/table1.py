"""Table 1 of Michalczyk & Cieplok 2014: ``python -m models.vibrator.paper.table1`` prints it.

Eight combinations of damping, horizontal stiffness and depth of the supports, by the averaged
theory and by simulation from standstill.
"""

import itertools

import numpy as np

from models.vibrator.parameters import Params, Rows, Settings
from models.vibrator.start import fast
from models.vibrator.theory import averaged

DAMPING_RATIOS = (0.01, 0.07)
STIFFNESSES_X = (6.21e5, 2.07e6)  # N/m
OFFSETS = (0.0, -0.4)  # m


def machines() -> Rows:
    """Return the eight machines of the table, in its order."""
    rows = np.array(list(itertools.product(DAMPING_RATIOS, STIFFNESSES_X, OFFSETS))).T
    nominal = {name: np.full(8, value) for name, value in Params._field_defaults.items()}
    varied = dict(zip(("damping_ratio", "stiffness_x", "support_offset"), rows, strict=True))
    return Params(**nominal | varied)


def main() -> None:
    """Print the table."""
    p = machines()
    guess = averaged.disphasing(p)
    outcome, _ = fast.outcomes(p, Settings())
    print("row    xi  k_x [N/m]  h [m]   dphi theory  simulated [rad]  [deg]   alpha [rad]")
    for i in range(8):
        print(
            f"{i + 1:3d}  {p.damping_ratio[i]:4.2f}  {p.stiffness_x[i]:9.3g}"
            f"  {p.support_offset[i]:5.1f}  {guess.angle[i]:12.5f}  {outcome.disphasing[i]:15.5f}"
            f"  {np.degrees(outcome.disphasing[i]):5.2f}  {outcome.angular_amplitude[i]:12.3g}"
        )


if __name__ == "__main__":
    main()
