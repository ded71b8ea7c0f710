"""Figures 3 to 11 of Ho, Nguyen & Woo 2011, from the mole."""

from collections.abc import Iterator
from math import tau
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.optimize import least_squares
from shown import Shown, name_panels, sheet

import uq
from models.mole.explore import history, poincare_section
from models.mole.paper.table import CLAIMS, closed_curves, described, responses
from models.mole.parameters import QUASI_PERIODIC, Params, Settings
from models.mole.theory.periods import common_periods
from uq import plots

PRINTED, PHYSICAL = Settings(formulation="as-printed"), Settings(formulation="physical")
LONG = 10.0  # s, of a whole time history
POINTS = 3000  # of a Poincare section
LOOK = {"formulation": "as-printed", "transient": 400, "duration": 800}  # of a basin
GRID = 21, 15  # points of a basin along displacement and velocity
MEASURED = {
    "2.5 Hz": "Measured motion is irregular, too, unlike that of the physical formulation.",
    "5 Hz": "Measured motion alternates, too, unlike that of the physical formulation.",
    "9 Hz": "Neither reproduces the measurement, 30 mm and quite regular.",
}
REACH = 0.05  # m, of the displacement over which a cosine is fitted to the inductance


def cosine_fit() -> tuple[float, float]:
    """Return the largest errors of a cosine fitted to (10), of its value and of its slope.

    Each over the largest value of the bar's inductance, or of its slope.
    """
    mole = Params()
    u = np.linspace(-REACH, REACH, 401)
    peak = mole.inductance_coefficient / (mole.inductance_width * np.sqrt(tau / 4))
    bar = peak * np.exp(-2 * u**2 / mole.inductance_width**2)
    slope = -4 * u / mole.inductance_width**2 * bar
    fitted = least_squares(
        lambda c: c[0] + c[1] * np.cos(c[2] * u) - bar, [peak / 2, peak / 2, tau / 2 / REACH]
    )
    _, amplitude, wave = fitted.x
    off = np.abs(-amplitude * wave * np.sin(wave * u) - slope)
    return float(np.abs(fitted.fun).max() / peak), float(off.max() / np.abs(slope).max())


OFF, STEEPNESS_OFF = cosine_fit()
NOTE = f"""\
J.-H. Ho, V.-D. Nguyen, K.-C. Woo, *Nonlinear dynamics of a new electro-vibro-impact system*,
Nonlinear Dynamics 63 (2011) 35-49. The paper's equation (20) lacks the ground friction in the bar's
equation, so energy is not conserved; the formulation `as-printed` is what the paper computed,
`physical` restores the missing terms. Figures show the former, and both in the narrow time windows.
Figure 2 is omitted: it compares the inductance with a measurement that was not published. The paper
prefers the Gaussian (10), which is modelled, to a cosine (11), which is not. A cosine that we
fitted to (10) within {REACH * 1e3:g} mm of the coil's centre differs from it by up to {OFF:.0%} of
the bar's inductance, but in slope, on which the force depends, by up to {STEEPNESS_OFF:.0%} of the
largest.
A period is counted in common periods of the control and half a mains cycle. For the claims as a
table, run `python -m models.mole.paper.table`."""


class Case(NamedTuple):
    """One of the paper's claims in both formulations.

    Attributes
    ----------
    says : str
        What the paper says.
    params : Params
    printed, physical : str
        The results, in words.
    measured : str
        What the paper's measurements add, if anything.
    """

    says: str
    params: Params
    printed: str
    physical: str
    measured: str

    def compared(self) -> str:
        """Return the comparison in sentences."""
        both = f"Paper: {self.says}. As printed: {self.printed}. Physical: {self.physical}."
        return f"{both} {self.measured}".rstrip()


def shown() -> Iterator[Shown]:
    """Yield the figures in the order of the paper."""
    told = cases()
    for number, frequency in ((3, 5.0), (4, 7.0), (5, 8.0), (6, 2.5), (7, 9.0)):
        yield time_histories(number, told[f"{frequency:g} Hz", 0])
    yield portrait(8, told["2.5 Hz", 0], 12)
    yield portrait(9, told["13 Hz", 0], 65)
    yield basins(told)
    yield two_orbits(told)


def cases() -> dict[tuple[str, int], Case]:
    """Return the claims, by label and the number of earlier ones with the same label."""
    outputs = {name: responses(name) for name in ("as-printed", "physical")}
    told: dict[tuple[str, int], Case] = {}
    for i, claim in enumerate(CLAIMS):
        params = Params(
            control_frequency=claim.control_frequency,
            initial_displacement=claim.start[0],
            initial_velocity=claim.start[1],
        )
        words = (in_words(params, name, found, i) for name, found in outputs.items())
        measured = MEASURED.get(claim.label, "")
        told[claim.label, (claim.label, 0) in told] = Case(claim.says, params, *words, measured)
    return told


def in_words(params: Params, formulation: Any, outputs: Any, i: int) -> str:
    """Describe the result for one of the claims in one formulation."""
    curves = 0
    if outputs["regime"][i] == QUASI_PERIODIC:
        curves = closed_curves(params, Settings(formulation=formulation))
    common = int(common_periods(params.control_frequency, params.supply_frequency))
    rate, extent = outputs["progression_rate"][i], outputs["displacement_range"][i]
    rate = round(rate, 4) + 0.0  # no minus sign before what is zero
    return (
        f"{described(outputs, i, common, curves)}, {rate * 1e3:.1f} mm/s, bar over "
        f"{extent * 1e3:.1f} mm"
    )


def time_histories(number: int, case: Case) -> Shown:
    """Draw the displacement of the bar, whole and from the third to the fourth second."""
    whole = history(case.params, PRINTED, 0.0, LONG, points=20_000)
    both = xr.concat(
        [history(case.params, one, 3.0, 4.0) for one in (PRINTED, PHYSICAL)],
        xr.DataArray(["as printed", "physical"], dims="formulation", name="formulation"),
        combine_attrs="drop_conflicts",
    )
    figure, panels = sheet(2, 1, 2.0)
    plots.curve(whole, "displacement", against="time", axes=panels[0])
    plots.curve(both, "displacement", against="time", axes=panels[1])
    name_panels(panels, ("as printed", "from the third to the fourth second"))
    hertz = f"{case.params.control_frequency:g}"
    return Shown(
        f"Figure {number}: displacement of the bar at {hertz} Hz",
        f"mole-{number}-{hertz.replace('.', '-')}-hz",
        figure,
        "Nominal mole from u = -0.022 m at rest.",
        case.compared(),
    )


def portrait(number: int, case: Case, dropped: int) -> Shown:
    """Draw a phase plane and the Poincare section, the first control periods dropped."""
    frequency = case.params.control_frequency
    orbit = history(case.params, PRINTED, dropped / frequency, (dropped + 40) / frequency, 40_000)
    section = poincare_section(case.params, PRINTED, POINTS, dropped)
    figure, panels = sheet(1, 2, 2.6)
    plots.phase_portrait(orbit, axes=panels[0])
    plots.section(section, axes=panels[1])
    name_panels(panels, ("phase plane, 40 control periods", f"Poincaré section, {POINTS} periods"))
    return Shown(
        f"Figure {number}: phase plane and Poincaré section at {frequency:g} Hz",
        f"mole-{number}-{frequency:g}-hz".replace(".", "-"),
        figure,
        f"As printed, from u = -0.022 m at rest; {dropped} control periods dropped; the section is "
        "taken whenever the relay closes.",
        case.compared(),
    )


def basins(told: dict[tuple[str, int], Case]) -> Shown:
    """Draw the basins of attraction at four control frequencies."""
    labels = ("29.5 rad/s", "31 rad/s", "32.8 rad/s", "47 rad/s")
    axes = {
        "initial_displacement": (-0.05, 0.005, GRID[0]),
        "initial_velocity": (-2.0, 2.0, GRID[1]),
    }
    figure, panels = sheet(2, 2, 3.0)
    shares = []
    for panel, label in zip(panels, labels, strict=True):
        fixed = {"control_frequency": told[label, 0].params.control_frequency}
        ds = uq.basins("mole", axes, fixed, LOOK, by=["progression_rate"])
        plots.basins(ds, ["progression_rate"], axes=panel)
        each = zip(ds["representative_regime"].values, ds["share"].values, strict=True)
        shares.append(f"{label}: " + ", ".join(f"{name} {share:.0%}" for name, share in each))
    name_panels(panels, labels)
    return Shown(
        "Figure 10: basins of attraction",
        "mole-10-basins",
        figure,
        f"As printed, {GRID[0]} x {GRID[1]} starts, {LOOK['transient']} control periods dropped "
        f"and {LOOK['duration']} observed, up to 16 times as many where these do not decide the "
        "regime; attractors are distinguished by regime and progression rate.",
        "The paper has chaos, period-2, period-1 and, at 47 rad/s, two period-1 attractors. Share "
        f"of the starts that lead to each of our attractors: {'; '.join(shares)}.",
    )


def two_orbits(told: dict[tuple[str, int], Case]) -> Shown:
    """Draw phase planes and Poincare sections of both orbits at 47 rad/s."""
    pair = [told["47 rad/s", i] for i in (0, 1)]
    figure, panels = sheet(2, 2, 2.6)
    frequency, dropped = 47 / tau, 37
    names = []
    for i, case in enumerate(pair):
        begin, end = dropped / frequency, (dropped + 20) / frequency
        orbit = history(case.params, PRINTED, begin, end, 20_000)
        plots.phase_portrait(orbit, axes=panels[2 * i])
        section = poincare_section(case.params, PRINTED, 1000, dropped)
        plots.section(section, axes=panels[2 * i + 1])
        start = (
            f"from ({case.params.initial_displacement:g} m, {case.params.initial_velocity:g} m/s)"
        )
        names += [start, f"Poincaré section, {start}"]
    name_panels(panels, names)
    return Shown(
        "Figure 11: the two attractors at 47 rad/s",
        "mole-11-47-rad-s",
        figure,
        f"As printed; {dropped} control periods dropped, 20 shown, and 1000 points per section.",
        f"From the first start: {pair[0].compared()} From the second: {pair[1].compared()} "
        "Closed curves are quasi-periodic. As printed, the one from the second start is smooth "
        "but steeply folded, and its exponent is near zero: it is close to a doubling of the "
        "torus.",
    )
