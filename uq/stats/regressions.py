"""Regressions of an output on inputs, by OpenTURNS: polynomial chaos and Gaussian process.

A regression is kept as plain numbers, from which it predicts the same bits in any process.
"""

from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.errors import InputError

MOST_TERMS = 500
"""Largest number of polynomials among which terms are selected."""

BEYOND = 0.25
"""Share of the range of the rows by which an input may leave it."""

FOLDS = 5
"""Number of parts of the rows that are predicted, each from the rows of the others."""

MOST_OF_PROCESS = 600
"""Largest number of rows of a Gaussian process, whose cost grows with their cube."""

_FOR_SCALES = 150  # rows from which the scales of a Gaussian process are estimated
_NORM = 0.6  # of the degrees of a polynomial: below 1, fewer products
_DEGREE = 16
_LARGEST_OF_NORMAL = 2.0  # cubes, and products of two: higher ones grow beyond all rows
_NUGGET = 0.01  # from which its estimate starts
_NUGGETS = (1e-6, 1e-4, 1e-2)  # with which a covariance is factorised in the end
_ROWS_PER_TERM = (4.0, 2.0, 1.0, 0.5)  # among which terms are selected
_RATIO = 3.0  # of largest to smallest value from which logarithms may be used
_FLAT = 2.2  # kurtosis below which a column counts as uniform; 1.8 of a uniform law

Fit = dict[str, Any]
"""Plain numbers from which a regression predicts."""

Predict = Callable[[Floats], tuple[Floats, Floats]]
"""Scaled inputs, shape (n, d) -> means, and standard deviations up to a factor, shape (n,) each."""


def openturns() -> Any:
    """Return OpenTURNS, silenced.

    Raises
    ------
    InputError
        When it is not installed.
    """
    try:
        import openturns
    except ImportError:
        raise InputError("emulators need OpenTURNS: pip install 'vibrolife[reliability]'") from None
    openturns.Log.Show(openturns.Log.NONE)
    openturns.TBB.Disable()  # rows are computed in parallel by the run itself
    # Of covariances with two nearly equal eigenvalues, which 50 iterations do not tell apart.
    openturns.ResourceMap.SetAsUnsignedInteger("Matrix-LargestEigenValueIterations", 10_000)
    return openturns


class Scale(NamedTuple):
    """Scale of an input in a regression: uniform on [-1, 1], or of mean 0 and sd 1.

    Attributes
    ----------
    name : str
    logarithmic, uniform : bool
    centre, half : float
        Of the range of a uniform input, else mean and standard deviation; of its logarithm if it is
        logarithmic.
    low, high : float
        Range of the rows, scaled.
    """

    name: str
    logarithmic: bool
    uniform: bool
    centre: float
    half: float
    low: float
    high: float

    def __call__(self, values: Floats) -> Floats:
        """Return scaled values."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return ((np.log(values) if self.logarithmic else values) - self.centre) / self.half


def standard_moment(values: Floats, power: int) -> float:
    """Return a moment of standardised values: skewness (3) or kurtosis (4)."""
    return float(np.mean(((values - values.mean()) / values.std()) ** power))


def scale_of(name: str, values: Floats) -> Scale:
    """Return the scale of an input by its values in the rows, which are not all equal."""
    logarithmic = bool(
        values.min() > 0
        and values.max() > _RATIO * values.min()
        and abs(standard_moment(np.log(values), 3)) < abs(standard_moment(values, 3))
    )
    column = np.log(values) if logarithmic else values
    uniform = standard_moment(column, 4) < _FLAT
    low, high = float(column.min()), float(column.max())
    centre, half = (
        ((low + high) / 2, (high - low) / 2)
        if uniform
        else (float(column.mean()), float(column.std()))
    )
    return Scale(
        name, logarithmic, uniform, centre, half, (low - centre) / half, (high - centre) / half
    )


def scaled(scales: list[Scale], x: Floats) -> Floats:
    """Return inputs scaled, shape (n, d), a column for each scale."""
    pairs = zip(scales, x.T, strict=True)
    return np.column_stack([scale(np.ascontiguousarray(column)) for scale, column in pairs])


def _basis(uniform: tuple[bool, ...]) -> Any:
    ot = openturns()
    factors = [ot.LegendreFactory() if flat else ot.HermiteFactory() for flat in uniform]
    enumerate_terms = ot.HyperbolicAnisotropicEnumerateFunction(len(uniform), _NORM)
    return ot.OrthogonalProductPolynomialFactory(
        [ot.OrthogonalUniVariatePolynomialFamily(factor) for factor in factors], enumerate_terms
    )


def fit_chaos(z: Floats, y: Floats, uniform: tuple[bool, ...]) -> Fit:
    """Return a sparse polynomial chaos expansion: its polynomials and their coefficients.

    Terms are selected by least angle regression and the corrected leave-one-out error [1]_, from
    the number of polynomials for which this error is least.

    References
    ----------
    .. [1] G. Blatman, B. Sudret, "Adaptive sparse polynomial chaos expansion based on least angle
       regression", J. Comput. Phys. 230, 2345-2367 (2011).
    """
    ot = openturns()
    basis = _basis(uniform)
    laws = [ot.Uniform(-1.0, 1.0) if flat else ot.Normal() for flat in uniform]
    selection = ot.LeastSquaresMetaModelSelectionFactory(ot.LARS(), ot.CorrectedLeaveOneOut())
    results, most = [], 0
    terms = basis.getEnumerateFunction()
    largest = _DEGREE**_NORM if all(uniform) else _LARGEST_OF_NORMAL
    while most < MOST_TERMS and np.sum(np.array(terms(most)) ** _NORM) < largest + 1e-9:
        most += 1
    constant = {"terms": [0], "coefficients": [float(y.mean())], "error": float(y.var())}
    for size in sorted({min(most, int(len(y) / few)) for few in _ROWS_PER_TERM}):
        algorithm = ot.FunctionalChaosAlgorithm(
            ot.Sample(z),
            ot.Sample(y[:, None]),
            ot.JointDistribution(laws),
            ot.FixedStrategy(basis, size),
            ot.LeastSquaresStrategy(selection),
        )
        with suppress(RuntimeError, TypeError):  # terms that the rows do not tell apart
            algorithm.run()
            results.append(algorithm.getResult())
    if not results:
        return constant
    result = min(results, key=lambda result: min(result.getErrorHistory()))
    return {
        "terms": [int(i) for i in result.getIndices()],
        "coefficients": [float(c) for c in np.array(result.getCoefficients())[:, 0]],
        "error": float(min(result.getErrorHistory())),
    }


def components(
    fit: Fit, z: Floats, uniform: tuple[bool, ...]
) -> dict[tuple[int, ...], tuple[float, Floats]]:
    """Return the parts of an expansion that depend on the same inputs, as in an ANOVA.

    Parameters
    ----------
    fit : dict
        From `fit_chaos`.
    z : ndarray, shape (n, d)
    uniform : tuple of bool

    Returns
    -------
    dict of tuple of int to (float, ndarray of shape (n,))
        Positions of the inputs -> variance of the part, and its values.
    """
    ot = openturns()
    basis = _basis(uniform)
    parts: dict[tuple[int, ...], tuple[float, Floats]] = {}
    for term, coefficient in zip(fit["terms"], fit["coefficients"], strict=True):
        powers = np.array(basis.getEnumerateFunction()(term))
        inputs = tuple(np.flatnonzero(powers).tolist())
        values = coefficient * np.array(basis.build(term)(ot.Sample(z)))[:, 0]
        variance, before = parts.get(inputs, (0.0, 0.0))
        parts[inputs] = (variance + coefficient**2 * bool(inputs), before + values)
    return parts


def _chaos(fit: Fit, z: Floats, y: Floats, uniform: tuple[bool, ...]) -> Predict:
    ot = openturns()
    basis = _basis(uniform)
    polynomials = [basis.build(i) for i in fit["terms"]]
    expansion = ot.LinearCombinationFunction(polynomials, fit["coefficients"])

    def predict(at: Floats) -> tuple[Floats, Floats]:
        return np.array(expansion(ot.Sample(at)))[:, 0], np.ones(len(at))

    return predict


def _process_fitter(z: Floats, y: Floats, fit: Fit) -> Any:
    ot = openturns()
    kernel = ot.MaternModel(fit["scale"], [fit["amplitude"]], 2.5)
    if "nugget" in fit:
        kernel.setNuggetFactor(fit["nugget"])
        kernel.activateNuggetFactor(True)
    trend = ot.ConstantBasisFactory(z.shape[1]).build()
    return ot.GaussianProcessFitter(ot.Sample(z), ot.Sample(y[:, None]), kernel, trend)


def fit_process(
    z: Floats,
    y: Floats,
    uniform: tuple[bool, ...],
    noisy: bool = False,
    start: Fit | None = None,
) -> Fit:
    """Return the most likely Gaussian process: a Matern 5/2 kernel, its scales and sd.

    They are estimated from the first 150 rows: the cost grows with the cube of their number. The
    variance of `noisy` rows about the process, relative to its own, is estimated, too (a nugget).
    The search begins at an earlier estimate, `start`, if there is one; it is the estimate if
    OpenTURNS cannot find a better one.
    """
    ot = openturns()
    d = z.shape[1]
    start = start or {"scale": [1.0] * d, "amplitude": 1.0} | ({"nugget": _NUGGET} if noisy else {})
    search = ot.Cobyla()
    search.setMaximumCallsNumber(300)
    search.setMaximumAbsoluteError(1e-3)
    search.setMaximumRelativeError(1e-3)
    search.setCheckStatus(False)
    low, high = ([1e-8], [10.0]) if noisy else ([], [])
    with suppress(RuntimeError):
        fitter = _process_fitter(z[:_FOR_SCALES], y[:_FOR_SCALES], start)
        fitter.setOptimizationAlgorithm(search)
        fitter.setOptimizationBounds(ot.Interval([0.02] * d + low, [50.0] * d + high))
        fitter.run()
        kernel = fitter.getResult().getCovarianceModel()
        fit = {"scale": list(kernel.getScale()), "amplitude": kernel.getAmplitude()[0]}
        return fit | ({"nugget": kernel.getNuggetFactor()} if noisy else {})
    return start


def process(fit: Fit, z: Floats, y: Floats, uniform: tuple[bool, ...]) -> Predict:
    """Return the prediction of the Gaussian process of `fit_process`, conditioned on rows.

    If OpenTURNS cannot factorise their covariance, as of rows that are close together, the nugget
    is increased.
    """
    ot = openturns()
    nuggets = [{"nugget": max(nugget, fit.get("nugget", 0.0))} for nugget in _NUGGETS]
    for change in ({}, *nuggets):
        with suppress(RuntimeError):
            fitter = _process_fitter(z, y, fit | change)
            fitter.setOptimizeParameters(False)
            fitter.run()
            regression = ot.GaussianProcessRegression(fitter.getResult())
            regression.run()
            break
    else:
        raise InputError("no Gaussian process fits the rows")
    mean = regression.getResult().getMetaModel()
    covariance = ot.GaussianProcessConditionalCovariance(regression.getResult())

    def predict(at: Floats) -> tuple[Floats, Floats]:
        variance = np.array(covariance.getConditionalMarginalVariance(ot.Sample(at)))[:, 0]
        return np.array(mean(ot.Sample(at)))[:, 0], np.sqrt(np.maximum(variance, 1e-20))

    return predict


def process_of(
    z: Floats,
    y: Floats,
    noisy: bool = False,
    start: Fit | None = None,
    renewed: bool = True,
) -> tuple[Fit, Predict]:
    """Return a Gaussian process of rows, and its prediction in the unit of the output.

    Parameters
    ----------
    z : ndarray, shape (n, d)
        Scaled inputs.
    y : ndarray, shape (n,)
        Not constant.
    noisy, start
        As for `fit_process`.
    renewed : bool
        Whether to estimate its scales again if there is a `start`.
    """
    flat, centre, sd = (False,) * z.shape[1], float(y.mean()), float(y.std())
    t = (y - centre) / sd
    fit = fit_process(z, t, flat, noisy, start) if renewed or start is None else start
    predict = process(fit, z, t, flat)

    def predicted(at: Floats) -> tuple[Floats, Floats]:
        mean, error = predict(at)
        return centre + sd * mean, sd * error

    return fit, predicted


CHAOS, PROCESS = "polynomial-chaos", "gaussian-process"

_KINDS: dict[str, tuple[Callable[..., Fit], Callable[..., Predict]]] = {
    CHAOS: (fit_chaos, _chaos),
    PROCESS: (fit_process, process),
}
"""Kind of regression -> its fit, and its prediction from plain numbers."""


class Regression(NamedTuple):
    """A regression of an output on scaled inputs, with the errors of predictions of other rows.

    Attributes
    ----------
    kind : str
    rows : list of int
        Positions of its rows among those of the emulator.
    values : list of float
        The output in these rows, standardised.
    mean, sd : float
        Of the output.
    fit : dict
        Fitted to all rows.
    folds : list of dict
        Fitted to the rows of all parts but one.
    errors : list of float
        Of each row, predicted from the other parts, over `sd`.
    deviations : list of float
        Predicted standard deviations of these errors, up to a factor.
    """

    kind: str
    rows: list[int]
    values: list[float]
    mean: float
    sd: float
    fit: Fit
    folds: list[Fit]
    errors: list[float]
    deviations: list[float]

    @property
    def q2(self) -> float:
        """Share of the variance that predictions from the other parts explain."""
        return 1.0 - float(np.mean(np.square(self.errors)))

    @property
    def error_sd(self) -> float:
        """Root of the mean squared error of predictions from the other parts."""
        return self.sd * float(np.sqrt(np.mean(np.square(self.errors))))


class ScaledInputs(NamedTuple):
    """Inputs of the rows of an emulator.

    Attributes
    ----------
    z : ndarray, shape (rows, d)
        Scaled.
    parts : ndarray of int, shape (rows,)
        Part of each row.
    uniform : tuple of bool
        Whether each input is uniform.
    """

    z: Floats
    parts: NDArray[np.int64]
    uniform: tuple[bool, ...]


class Predictor:
    """Predictions of a regression, prepared when they are first needed.

    Parameters
    ----------
    regression : Regression
    inputs : ScaledInputs
        Of all rows of the emulator.
    """

    def __init__(self, regression: Regression, inputs: ScaledInputs):
        self.regression = regression
        rows = np.array(regression.rows)
        self._inputs = inputs._replace(z=inputs.z[rows], parts=inputs.parts[rows])
        self._y = np.array(regression.values)
        self._part = cache(self._prepared)
        # Where rows are close together, a process predicts far smaller ones than its errors.
        self._least = float(np.mean(regression.deviations))
        self.standard_errors = regression.errors / np.maximum(regression.deviations, self._least)

    def _prepared(self, part: int) -> Predict:
        """Return the prediction from all rows (-1), or from those of all parts but one."""
        z, parts, uniform = self._inputs
        kept = parts != part
        fit = self.regression.fit if part < 0 else self.regression.folds[part]
        predict = _KINDS[self.regression.kind][1](fit, z[kept], self._y[kept], uniform)
        if part < 0:
            return predict
        low, high = z[kept].min(axis=0), z[kept].max(axis=0)
        margin = BEYOND * (high - low)
        return lambda at: predict(np.clip(at, low - margin, high + margin))

    def __call__(self, z: Floats) -> tuple[Floats, Floats]:
        """Return means, and standard deviations up to a factor, shape (n,) each."""
        mean, sd = self._part(-1)(z)
        sd = np.maximum(sd, self._least)
        return self.regression.mean + self.regression.sd * mean, self.regression.sd * sd

    def cross_fitted(self, z: Floats, parts: NDArray[np.int64]) -> Floats:
        """Return means, each from the rows of all parts but that of the row, shape (n,).

        Rows far outside the others are predicted as at the edge: whether a row is there must not
        depend on the row itself.
        """
        mean = np.empty(len(z))
        for part in np.unique(parts):
            mean[parts == part] = self._part(int(part))(z[parts == part])[0]
        return self.regression.mean + self.regression.sd * mean


def regress(
    inputs: ScaledInputs,
    y: Floats,
    rows: NDArray[np.int64],
    kinds: tuple[str, ...] = (CHAOS, PROCESS),
) -> Regression:
    """Return the kind of regression that predicts parts of the rows best from the others.

    Parameters
    ----------
    inputs : ScaledInputs
        Of all rows of the emulator.
    y : ndarray, shape (n,)
        Not constant.
    rows : ndarray of int, shape (n,)
        Positions of its rows among those of the emulator.
    kinds : tuple of str
        A Gaussian process is left out where there are too many rows.
    """
    z, parts, uniform = inputs.z[rows], inputs.parts[rows], inputs.uniform
    mean, sd = float(y.mean()), float(y.std())
    t = (y - mean) / sd
    candidates = list[Regression]()
    for kind in kinds if len(t) <= MOST_OF_PROCESS else (CHAOS,):
        fit, prediction = _KINDS[kind]
        folds, errors = list[Fit](), np.zeros(len(t))
        deviations = np.ones(len(t))
        for part in range(FOLDS):
            others, these = parts != part, parts == part
            folds.append(fit(z[others], t[others], uniform))
            if these.any():
                predict = prediction(folds[-1], z[others], t[others], uniform)
                predicted, deviations[these] = predict(z[these])
                errors[these] = t[these] - predicted
        crossed = folds, errors.tolist(), deviations.tolist()
        candidates.append(Regression(kind, rows.tolist(), t.tolist(), mean, sd, {}, *crossed))
    best = max(candidates, key=lambda regression: regression.q2)
    return best._replace(fit=_KINDS[best.kind][0](z, t, uniform))
