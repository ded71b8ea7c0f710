"""Observables: quantities of a result that can be inspected, with values in all its rows."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask, Output
from uq.errors import InputError, choices, nearest
from uq.learning.inspections import OUTCOMES, Inspection, InspectionKind
from uq.learning.likelihood import log_likelihood
from uq.result.element import places
from uq.result.result import Result
from uq.text.element_names import same_name

_BETWEEN = 16
"""Points per interval of declared depths at which the monotone curve is tabulated."""

_REACH = 3.0  # standard errors of a measurement
_SAME = 0.01  # relative difference of likelihoods considered equal
_FAR = 1e6  # times the last declared depth


@dataclass(frozen=True)
class WornDepths:
    """Worn depth of each row as a function of time.

    Monotone interpolation of the time as a function of depth, starting at zero, with linear
    extrapolation beyond the last depth. If a row never reaches the next declared depth, its depth
    stays at the last one reached.

    Parameters
    ----------
    depths : ndarray, shape (k,)
        Ascending, positive.
    lives : ndarray, shape (n, k)
        Time until each row reaches each depth; infinite where it never does, NaN where the row
        has none.
    """

    depths: Floats
    lives: Floats

    def at(self, time: Floats) -> Floats:
        """Return the depth of each row at its times.

        Parameters
        ----------
        time : ndarray, shape (n, g)
            In the unit of the lives.

        Returns
        -------
        ndarray, shape (n, g)
            NaN where a row has no life.
        """
        grid, curves = self._curves()
        depth = np.full(time.shape, np.nan)
        for row in np.flatnonzero(~np.isnan(self.lives).any(axis=1)):
            finite = np.isfinite(curves[row])
            depth[row] = np.interp(time[row], curves[row, finite], grid[finite])
            if finite.all():
                slope = (grid[-1] - grid[-2]) / (curves[row, -1] - curves[row, -2])
                later = np.maximum(time[row] - curves[row, -1], 0.0)
                depth[row] += later * slope
        return depth

    @property
    def settled(self) -> Mask:
        """Whether each row's wear stops before the last depth, shape (n,)."""
        return np.asarray(np.isposinf(self.lives).any(axis=1))

    def error(self) -> Floats:
        """Return the largest leave-one-out interpolation error of each row, relative, shape (n,).

        Maximum over the inner depths; NaN with fewer than three depths, or if a depth is not
        reached.
        """
        worst = np.full(len(self.lives), np.nan)
        whole = np.isfinite(self.lives).all(axis=1)
        for place in range(len(self.depths) - 1):
            others = WornDepths(np.delete(self.depths, place), np.delete(self.lives, place, axis=1))
            guess = others.at(self.lives[:, place : place + 1])[:, 0]
            off = np.abs(guess / self.depths[place] - 1)
            worst[whole] = np.fmax(worst, off)[whole]
        return worst

    def _curves(self) -> tuple[Floats, Floats]:
        """Return tabulated depths and the time to each in every row."""
        from scipy.interpolate import PchipInterpolator

        ends = np.concatenate([[0.0], self.depths])
        grid = np.unique(
            np.concatenate(
                [np.linspace(a, b, _BETWEEN + 1) for a, b in zip(ends, ends[1:], strict=False)]
            )
        )
        curves = np.full((len(self.lives), len(grid)), np.inf)
        reached = np.isfinite(self.lives).sum(axis=1)
        for count in np.unique(reached):
            rows = reached == count
            upto = grid <= ends[count]
            times = np.column_stack([np.zeros(rows.sum()), self.lives[rows, :count]])
            if count:
                curve = PchipInterpolator(ends[: count + 1], times, axis=1)(grid[upto])
                curves[np.ix_(rows, upto)] = curve
            else:
                curves[rows, 0] = 0.0
        return grid, curves


@dataclass(frozen=True)
class Observable:
    """A quantity that can be inspected, with its values in all rows of a result.

    Attributes
    ----------
    name : str
    declared : Output
        The output, or the lives until the depths worn.
    values : ndarray, shape (n,)
        Of an output; of a censored life its lower bound. Empty for a depth.
    depths : WornDepths or None
        Of a depth, with censored lives as infinite.
    censored : ndarray of bool, shape (n,)
        Where a life is only bounded; of a depth, where one of the lives is.
    time_unit : str
        Of the time of an inspection: that of the life; "" where there is none.
    """

    name: str
    declared: Output
    values: Floats
    depths: WornDepths | None
    censored: Mask
    time_unit: str

    @property
    def unit(self) -> str:
        """Of its values."""
        return self.declared.unit

    def truth(self, time: float | None, rows: NDArray[np.intp], life_factor: Floats) -> Floats:
        """Return the true value of the observable at an inspection.

        Parameters
        ----------
        time : float or None
            Of the inspection, in `time_unit`.
        rows : ndarray of int, shape (n,)
        life_factor : ndarray, shape (n, g)
            Factors that lengthen the computed lives of these rows.

        Returns
        -------
        ndarray, shape (n, g)
        """
        if self.depths is not None:
            assert time is not None
            chosen = WornDepths(self.depths.depths, self.depths.lives[rows])
            return chosen.at(time / life_factor)
        values = self.values[rows, None]
        return (
            values * life_factor
            if self.declared.is_lifetime
            else np.broadcast_to(values, life_factor.shape)
        )

    def log_likelihood(self, inspection: Inspection, truth: Floats, model_cv: float) -> Floats:
        """Return the log-likelihood of an inspection, given `truth`."""
        if self.declared.is_angle:
            truth = self._angle(inspection, truth)
        return log_likelihood(inspection, truth, model_cv)

    def _angle(self, inspection: Inspection, truth: Floats) -> Floats:
        """Return angles unwrapped to the turn of the measured value; for a limit, magnitudes."""
        if inspection.kind is not InspectionKind.MEASURED or inspection.value is None:
            return np.abs(truth)
        turn = 2 * np.pi if self.unit == "rad" else 360.0
        return inspection.value + (truth - inspection.value + turn / 2) % turn - turn / 2

    def bounded(
        self, inspection: Inspection, rows: NDArray[np.intp], life_factor: Floats, model_cv: float
    ) -> Mask:
        """Return the mask of values whose bounds do not determine the likelihood, shape (n, g).

        If wear stops, the depth is only bounded by two declared depths. If the life is censored,
        the depth is only bounded from below by the last depth reached.
        """
        if self.depths is not None:
            assert inspection.time is not None
            least = self.truth(inspection.time, rows, life_factor)
            both = (least, np.broadcast_to(self._most(rows)[:, None], least.shape))
            first, last = (np.exp(self.log_likelihood(inspection, end, model_cv)) for end in both)
            differ = np.abs(first - last) > _SAME * np.maximum(first, last)
            return differ & self.open_depth(inspection.time, rows, life_factor)
        most = (inspection.time or 0.0) if inspection.kind in OUTCOMES else reach(inspection)
        return self.censored[rows, None] & (self.values[rows, None] * life_factor < most)

    def open_depth(self, time: float, rows: NDArray[np.intp], life_factor: Floats) -> Mask:
        """Return the mask of depths at a time that are only bounded, shape (n, g)."""
        assert self.depths is not None
        lives = self.depths.lives[rows]
        last = np.where(np.isfinite(lives), lives, 0.0).max(axis=1, keepdims=True)
        return (time / life_factor > last) & self.depths.settled[rows, None]

    def _most(self, rows: NDArray[np.intp]) -> Floats:
        """Return an upper bound of the depth of each row, from its lives, shape (n,)."""
        assert self.depths is not None
        beyond = np.append(self.depths.depths, _FAR * self.depths.depths[-1])
        reached = np.isfinite(self.depths.lives[rows]).sum(axis=1)
        return np.where(self.censored[rows], beyond[-1], beyond[reached])


def observables_of(result: Result) -> dict[str, Observable]:
    """Return the observables of a result, or of a selection of its rows, by name.

    Outputs, element by element, and the depths that its lives are declared for.
    """
    numbers = [name for name, output in result.outputs.items() if not output.is_category]
    elements = list(result.elements(numbers, every=True))
    units = {element.units for element in elements if element.is_lifetime}
    only = units.pop() if len(units) == 1 else ""
    observables = {
        element.name: Observable(
            element.name,
            element.declared,
            element.values,
            None,
            element.censored,
            element.units if element.is_lifetime else only,
        )
        for element in elements
    }
    return observables | {
        depth.name: depth for depth in _depths(result) if depth.name not in observables
    }


def as_named(observables: Mapping[str, Observable], inspection: Inspection) -> Inspection:
    """Return the inspection with the canonical name of its output in the result."""
    name = same_name(inspection.output, [*observables])
    return inspection if name == inspection.output else replace(inspection, output=name)


def observed(rows: Result, inspections: Sequence[Inspection]) -> dict[Inspection, Observable]:
    """Return the observable of each inspection.

    Raises
    ------
    InputError
        One line for each inspection of a quantity that the result does not have, or that cannot be
        inspected in this way.
    """
    faults: list[str] = []
    observable_by_inspection = {}
    observables = observables_of(rows)
    for inspection in inspections:
        try:
            observable_by_inspection[inspection] = observable_of(observables, inspection)
        except InputError as error:
            where = f"{inspection.where}: unit {inspection.unit}"
            faults += [f"{where}: {line}" for line in error.lines]
    if faults:
        raise InputError(*faults)
    return observable_by_inspection


def observable_of(observables: Mapping[str, Observable], inspection: Inspection) -> Observable:
    """Return the observable of an inspection.

    Raises
    ------
    InputError
        When there is no such quantity, or it cannot be inspected in this way.
    """
    name = inspection.output
    if name not in observables:
        raise InputError(
            f"output = {name}: no such output{nearest(name, observables)} (allowed:"
            f" {choices(observables)})"
        )
    observable = observables[name]
    lives = [life for life in observables.values() if life.declared.is_lifetime]
    if observable.depths is None:
        _check_output(observable, inspection, list({life.unit: None for life in lives}))
    elif inspection.kind in OUTCOMES:
        raise InputError(
            f"output = {name}: a depth does not end; name a life (allowed:"
            f" {choices(life.name for life in lives)})"
        )
    elif inspection.time is None:
        raise InputError(f"time is missing: when {name} was inspected [{observable.time_unit}]")
    else:
        _check_reach(observable, inspection, float(observable.depths.depths[-1]))
    return observable


def _check_output(
    observable: Observable, inspection: Inspection, time_units: Sequence[str]
) -> None:
    if inspection.kind in OUTCOMES and not observable.declared.is_lifetime:
        raise InputError(
            f"kind = {inspection.kind}: {inspection.output} is not a life; write measured, below or"
            " above"
        )
    if inspection.time is None or inspection.kind in OUTCOMES:
        return
    if observable.declared.is_lifetime:
        raise InputError(
            f"time = {inspection.time:g}: leave it out where a life is {inspection.kind}: the life"
            " is the value"
        )
    if len(time_units) > 1:
        raise InputError(
            f"time = {inspection.time:g}: leave it out: {inspection.output} is not a life, and"
            f" lives are in several units ({choices(time_units)})"
        )


def _depths(result: Result) -> Iterator[Observable]:
    """Yield the depths that the lives of a result are declared for, such as ``depth[site=left]``.

    A dimension with a unit, along which an output is a life, is a depth. Of several outputs with
    the same dimensions the first counts.
    """
    seen = set()
    for output, declared in result.outputs.items():
        if not declared.is_lifetime or not declared.dims:
            continue
        depth = declared.dims[-1]
        axis = result.dataset[depth]
        if "units" not in axis.attrs or not np.issubdtype(axis.dtype, np.number):
            continue
        elements = list(result.elements([output], every=True))
        others = {dim: result.dataset[dim].values for dim in declared.dims[:-1]}
        size = axis.size
        for number, (name, _, _) in enumerate(places(depth, others)):
            if name in seen:
                continue
            seen.add(name)
            lives = elements[number * size : (number + 1) * size]
            cut = np.stack([element.censored for element in lives], axis=1)
            times = np.stack([element.values for element in lives], axis=1)
            order = np.argsort(axis.values)
            worn = WornDepths(
                axis.values[order].astype(float), np.where(cut, np.inf, times)[:, order]
            )
            shown = Output(str(axis.attrs["units"]), declared.meaning, scales=declared.exponents)
            censored = np.asarray(cut.any(axis=1))
            yield Observable(name, shown, np.empty(0), worn, censored, declared.unit)


def reach(inspection: Inspection) -> float:
    """Return the largest value that an inspection can distinguish from larger values."""
    if inspection.detection_90 is not None:
        return inspection.detection_90
    assert inspection.value is not None
    if inspection.kind is not InspectionKind.MEASURED:
        return inspection.value
    if inspection.cv is not None:
        return inspection.value * float(np.exp(_REACH * inspection.cv))
    return inspection.value + _REACH * (inspection.sd or 0.0)


def _check_reach(observable: Observable, inspection: Inspection, last: float) -> None:
    """Refuse a depth beyond the last declared depth of the result."""
    if (most := reach(inspection)) > last:
        raise InputError(
            f"value = {inspection.value or most:g}: with its error it reaches {most:.3g}"
            f" {observable.unit}, beyond the last depth of the result, {last:g} {observable.unit};"
            " add a deeper one to the study's depths"
        )
