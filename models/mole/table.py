"""The claims of Ho, Nguyen & Woo 2011 and the model: ``python -m models.mole.table`` prints both.

Each claim is looked at in two formulations: as printed, which is what the paper computed, and
physical, with the friction of the mole on the bar and the jump of the voltage restored.
"""

from math import tau
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.mole.batch import batch
from models.mole.parameters import CHAOTIC, NO_IMPACT, PERIODIC, REGIMES, Params, Settings
from models.mole.periods import common_periods

LONG = 4000  # control periods over which the exponent of a chaotic response is averaged

NOTE = """\
A period counts common periods of control and half a mains cycle. The paper's exponent 6.67 at
2.5 Hz is not the model's: leaving the jumps of the tangent flow at friction and contact switchings
out of account, one finds 6.6 bit/s, and a positive number on periodic orbits as well. At 9 Hz the
bar does not reach the stop as printed; with the voltage's jump at switching restored it does."""


class Claim(NamedTuple):
    """What the paper says of one case.

    Attributes
    ----------
    label : str
    control_frequency : float
        [Hz]
    says : str
    start : tuple of float
        Initial displacement [m] and velocity [m/s].
    """

    label: str
    control_frequency: float
    says: str
    start: tuple[float, float] = (-0.022, 0.0)


CLAIMS = (
    Claim("2.5 Hz", 2.5, "chaos, exponent 6.67"),
    Claim("5 Hz", 5.0, "amplitude alternates"),
    Claim("7 Hz", 7.0, "amplitude rises and falls"),
    Claim("8 Hz", 8.0, "synchronous, near optimum"),
    Claim("9 Hz", 9.0, "5 mm, measured 30 mm"),
    Claim("13 Hz", 13.0, "bounded chaos"),
    Claim("29.5 rad/s", 29.5 / tau, "chaos"),
    Claim("31 rad/s", 31 / tau, "period-2"),
    Claim("32.8 rad/s", 32.8 / tau, "period-1"),
    Claim("47 rad/s", 47 / tau, "period-1"),
    Claim("47 rad/s", 47 / tau, "another period-1", (-0.045, -1.0)),
)


def rows() -> NDArray[np.float64]:
    """Return the parameters of the claims, shape (11, d)."""
    nominal = Params()
    return np.array(
        [
            nominal._replace(
                control_frequency=claim.control_frequency,
                initial_displacement=claim.start[0],
                initial_velocity=claim.start[1],
            )
            for claim in CLAIMS
        ]
    )


def responses(formulation: Any) -> dict[str, NDArray[Any]]:
    """Return the outputs of all claims in one formulation."""
    x = rows()
    outputs, _ = batch(x, np.zeros(len(x), np.uint64), Settings(formulation=formulation))
    chaotic = np.flatnonzero(outputs["regime"] == CHAOTIC)
    settings = Settings(formulation=formulation, duration=LONG)
    longer, _ = batch(x[chaotic], np.zeros(len(chaotic), np.uint64), settings)
    for name, values in longer.items():
        outputs[name][chaotic] = values
    return outputs


def described(outputs: dict[str, NDArray[Any]], i: int, common: int) -> str:
    """Say in a few words what one response is."""
    regime, period = outputs["regime"][i], int(outputs["period"][i])
    exponent = f"{outputs['lyapunov_exponent'][i]:.3g}"
    if regime == CHAOTIC:
        exponent = f"{outputs['lyapunov_exponent'][i]:.3f} +- "
        exponent += f"{outputs['lyapunov_exponent_error'][i]:.3f}"
    name = REGIMES[regime]
    if period and regime in (PERIODIC, NO_IMPACT):
        name = f"period-{period}" if regime == PERIODIC else f"no impact, period-{period}"
        name += f" of {common}" if common > 1 else ""
    return f"{name}, {exponent} 1/s"


def main() -> None:
    """Print the table."""
    x = rows()
    frequency = x[:, Params._fields.index("control_frequency")]
    supply = x[:, Params._fields.index("supply_frequency")]
    common = common_periods(frequency, supply)
    both = {name: responses(name) for name in ("as-printed", "physical")}
    for i, claim in enumerate(CLAIMS):
        print(f"{claim.label}, from u = {claim.start[0]:g} m, v = {claim.start[1]:g} m/s")
        print(f"  paper       {claim.says}")
        for name, outputs in both.items():
            rate, range_ = outputs["progression_rate"][i], outputs["displacement_range"][i]
            print(
                f"  {name:10s}  {described(outputs, i, common[i]):44s}"
                f" {rate * 1e3:7.2f} mm/s {range_ * 1e3:6.1f} mm"
            )
    print(NOTE)


if __name__ == "__main__":
    main()
