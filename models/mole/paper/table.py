"""The claims of Ho, Nguyen & Woo 2011 against the model: ``python -m models.mole.paper.table``.

Each claim is checked in two formulations: as printed, which is what the paper computed, and
physical, with the friction of the mole on the bar and the jump of the voltage restored.
"""

from math import tau
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.mole.batch import batch
from models.mole.explore import poincare_section
from models.mole.parameters import (
    CHAOTIC,
    NO_IMPACT,
    PERIODIC,
    QUASI_PERIODIC,
    REGIMES,
    UNDECIDED,
    Params,
    Settings,
)
from models.mole.theory.periods import common_periods

STARTS = 16  # neighbouring starts over which a chaotic response is averaged, too
LONG = 3000  # control periods of each
LONGEST = 25_600  # control periods if the regime is undecided
CURVE = 2000  # strobe points by which closed curves are counted

NOTE = """\
A period is counted in common periods of the control and half a mains cycle. At 29.5 to 47 rad/s
there is none, and the simplest response is one closed curve of the states at which the relay
closes. The paper's exponent of 6.67 at 2.5 Hz is not the model's: if the jumps of the tangent flow
at the ends of slip phases are neglected, one finds 6.6 bit/s, and positive values on periodic
orbits as well. At 9 Hz, as printed, the bar does not reach the stop; with the voltage jump at
switching restored it does, but chaotically over 56 mm, where 30 mm were measured, "quite regular".
Irregular motion at 2.5 Hz and alternation at 5 Hz were measured, but do not occur in the physical
formulation. From the second start at 47 rad/s, as printed, the closed curve is steeply folded: it
is near a doubling of the torus."""


class Claim(NamedTuple):
    """The paper's claim about one case.

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
    many = np.repeat(x[chaotic], STARTS, axis=0)
    many[:, Params._fields.index("initial_displacement")] += np.tile(
        1e-5 * np.arange(STARTS), len(chaotic)
    )
    settings = Settings(formulation=formulation, duration=LONG)
    longer, _ = batch(many, np.zeros(len(many), np.uint64), settings)
    for name in ("progression_rate", "lyapunov_exponent"):
        values = longer[name].reshape(-1, STARTS)
        outputs[name][chaotic] = values.mean(axis=1)
        outputs[f"{name}_error"][chaotic] = values.std(axis=1, ddof=1) / np.sqrt(STARTS)
    undecided = np.flatnonzero(outputs["regime"] == UNDECIDED)
    settings = Settings(formulation=formulation, duration=LONGEST)
    longest, _ = batch(x[undecided], np.zeros(len(undecided), np.uint64), settings)
    for name, values in longest.items():
        outputs[name][undecided] = values
    return outputs


def closed_curves(params: Params, settings: Settings) -> int:
    """Count the closed curves on which a quasi-periodic response meets its strobe, 0 if too many.

    With n curves, every n-th state lies on the same one, at a place given by the mains' phase: in
    the order of phases, neighbours are close.
    """
    section = poincare_section(params, settings, CURVE, dropped=400)
    u = section["displacement"].to_numpy()
    turns = section["period"].to_numpy() * params.supply_frequency / params.control_frequency
    phase = np.mod(2 * turns, 1.0)
    for n in range(1, 9):
        steps = [np.abs(np.diff(u[k::n][np.argsort(phase[k::n])])) for k in range(n)]
        if np.percentile(np.concatenate(steps), 90) < 0.02 * np.ptp(u):
            return n
    return 0


def described(outputs: dict[str, NDArray[Any]], i: int, common: int, curves: int) -> str:
    """Describe one response in a few words."""
    regime, period = outputs["regime"][i], int(outputs["period"][i])
    exponent = f"{outputs['lyapunov_exponent'][i]:.3g}"
    if regime == CHAOTIC:
        exponent = f"{outputs['lyapunov_exponent'][i]:.3f} +- "
        exponent += f"{outputs['lyapunov_exponent_error'][i]:.3f}"
    name = REGIMES[regime]
    if curves:
        name = "closed curve" if curves == 1 else f"{curves} closed curves"
    if period and regime in (PERIODIC, NO_IMPACT):
        name = f"period-{period}" if regime == PERIODIC else f"no impact, period-{period}"
        name += f" of {common}" if common > 1 else ""
    return f"{name}, exponent {exponent} 1/s"


def main() -> None:
    """Print the table."""
    x = rows()
    frequency = x[:, Params._fields.index("control_frequency")]
    supply = x[:, Params._fields.index("supply_frequency")]
    common = common_periods(frequency, supply)
    formulations: tuple[Any, ...] = ("as-printed", "physical")
    both = {name: responses(name) for name in formulations}
    for i, claim in enumerate(CLAIMS):
        print(f"{claim.label}, from u = {claim.start[0]:g} m, v = {claim.start[1]:g} m/s")
        print(f"  paper       {claim.says}")
        for name, outputs in both.items():
            curves = 0
            if outputs["regime"][i] == QUASI_PERIODIC:
                curves = closed_curves(Params._make(x[i]), Settings(formulation=name))
            rate, range_ = outputs["progression_rate"][i], outputs["displacement_range"][i]
            print(
                f"  {name:10s}  {described(outputs, i, common[i], curves):53s}"
                f" {rate * 1e3:7.2f} mm/s {range_ * 1e3:6.1f} mm"
            )
    print(NOTE)


if __name__ == "__main__":
    main()
