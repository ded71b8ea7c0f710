"""Likelihood of an inspection, given the true value of the observable."""

from collections.abc import Callable
from math import log, sqrt

import numpy as np
from scipy import special

from uq.contract import Floats, Mask
from uq.learning.inspections import OUTCOMES, Inspection, InspectionKind

_AGREES: dict[InspectionKind, Callable[..., Mask]] = {
    InspectionKind.BELOW: np.less,
    InspectionKind.ABOVE: np.greater,
    InspectionKind.SURVIVED: np.greater,
    InspectionKind.ENDED: np.less_equal,
}
_NINETY = float(special.ndtri(0.9))


def log_likelihood(inspection: Inspection, truth: Floats, model_cv: float = 0.0) -> Floats:
    """Return the log-likelihood of an inspection, given the true value.

    Parameters
    ----------
    inspection : Inspection
    truth : ndarray
        Values of the observed quantity, in the unit of the inspection, or lives for a survival
        outcome; NaN where missing.
    model_cv : float
        Coefficient of variation of the model error: lognormal with median 1 if combined with a
        lognormal error or a detection curve; normal with a normal error or an exact limit.

    Returns
    -------
    ndarray
        Same shape as `truth`; -inf where the inspection is impossible or the row has no value.
    """
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        logarithm = _of_kind(inspection, np.asarray(truth, dtype=float), model_cv)
    return np.where(np.isnan(logarithm), -np.inf, logarithm)


def _of_kind(inspection: Inspection, truth: Floats, model_cv: float) -> Floats:
    value = inspection.value
    if inspection.kind in OUTCOMES:
        return _log_whether(inspection.kind, truth, inspection.time)
    if inspection.detection_50 is not None and inspection.detection_90 is not None:
        half, ninety = log(inspection.detection_50), log(inspection.detection_90)
        scale = np.hypot((ninety - half) / _NINETY, _sigma(model_cv))
        seen = (np.log(truth) - half) / scale
        return _log_side(inspection.kind, -seen)
    assert value is not None
    if inspection.cv is not None:
        scale = np.hypot(_sigma(inspection.cv), _sigma(model_cv))
        z = (log(value) - np.log(truth)) / scale
        spread = value * scale
    else:
        spread = np.hypot(inspection.sd or 0.0, np.abs(truth) * model_cv)
        if inspection.sd is None and not model_cv:  # a limit without error
            return _log_whether(inspection.kind, truth, value)
        z = (value - truth) / spread
    if inspection.kind is InspectionKind.MEASURED:
        return np.asarray(-(z**2) / 2 - np.log(spread) - log(2 * np.pi) / 2)
    return _log_side(inspection.kind, z)


def _log_whether(kind: InspectionKind, truth: Floats, limit: float | None) -> Floats:
    """Return the log-likelihood of an error-free observation: 0 if consistent, else -inf."""
    return np.where(_AGREES[kind](truth, limit), 0.0, -np.inf)


def _log_side(kind: InspectionKind, z: Floats) -> Floats:
    """Return the log probability of one side of a limit, for a truth `z` errors above it."""
    return np.asarray(special.log_ndtr(z if kind is InspectionKind.BELOW else -z))


def _sigma(cv: float) -> float:
    return sqrt(np.log1p(cv**2))


def drawn_measurement(
    inspection: Inspection, truth: Floats, rng: np.random.Generator, model_cv: float = 0.0
) -> Floats:
    """Draw simulated measurements.

    Parameters
    ----------
    inspection : Inspection
        Of kind ``measured``.
    truth : ndarray
    rng : numpy.random.Generator
    model_cv : float
        As for `log_likelihood`.

    Returns
    -------
    ndarray
        Same shape as `truth`, NaN where `truth` is missing.
    """
    noise = rng.standard_normal(truth.shape)
    if inspection.cv is not None:
        return np.asarray(truth * np.exp(np.hypot(_sigma(inspection.cv), _sigma(model_cv)) * noise))
    return np.asarray(truth + np.hypot(inspection.sd or 0.0, np.abs(truth) * model_cv) * noise)


def log_most(inspection: Inspection, model_cv: float = 0.0) -> float:
    """Return the largest log-likelihood of an inspection over all true values (upper bound)."""
    if inspection.kind is not InspectionKind.MEASURED:
        return 0.0
    assert inspection.value is not None
    if inspection.cv is not None:
        spread = inspection.value * np.hypot(_sigma(inspection.cv), _sigma(model_cv))
    else:
        spread = inspection.sd or 0.0
    return float(-np.log(spread) - log(2 * np.pi) / 2)
