"""Functions with known answers, declared as models.

They pass through the same code as the machines, so that every number the platform prints can be
compared with a closed form. Each is computed element by element: a row's result does not depend on
the other rows, to the bit.
"""

import os
import time
from dataclasses import dataclass
from math import pi
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Model, Output, Parameter, Setting, Status

Array = NDArray[np.float64]
Result = tuple[dict[str, Array], NDArray[np.int8]]


@dataclass(frozen=True)
class NoSettings:
    """A closed form needs no numerical choices."""


def _ok(rows: int) -> NDArray[np.int8]:
    return np.full(rows, Status.OK, np.int8)


def _columns(x: Array) -> Array:
    # Contiguous columns: numpy may use other code for strided ones, with other last bits.
    return np.ascontiguousarray(x.T)


def _input(symbol: str, low: float, high: float) -> Parameter:
    return Parameter(symbol, "1", "independent input", (low, high), "definition of the function")


class IshigamiParameters(NamedTuple):
    """Inputs of the Ishigami function."""

    x1: Annotated[float, _input("x_1", -pi, pi)] = 0.0
    x2: Annotated[float, _input("x_2", -pi, pi)] = 0.0
    x3: Annotated[float, _input("x_3", -pi, pi)] = 0.0


def ishigami(x: Array, seed: NDArray[np.uint64], settings: NoSettings) -> Result:
    """Evaluate y = sin x1 + a sin^2 x2 + b x3^4 sin x1 with a = 7, b = 0.1.

    With independent inputs uniform on [-pi, pi], the mean is a/2 and the variance
    V = a^2/8 + b pi^4/5 + b^2 pi^8/18 + 1/2. First-order indices: (1/2) (1 + b pi^4/5)^2 / V,
    a^2/(8 V), 0; total indices: S1 + S13, S2, S13 with S13 = 8 b^2 pi^8 / (225 V).

    Parameters
    ----------
    x : ndarray, shape (n, 3)
        [1]
    seed : ndarray, shape (n,)
        Not used.
    settings : NoSettings

    Returns
    -------
    outputs : dict
        ``y``, shape (n,) [1].
    status : ndarray, shape (n,)

    References
    ----------
    T. Ishigami, T. Homma, "An importance quantification technique in uncertainty analysis for
    computer models", ISUMA '90, 398-403 (1990).
    """
    x1, x2, x3 = _columns(x)
    sine = np.sin(x2)
    square = x3 * x3
    return {"y": (1.0 + 0.1 * square * square) * np.sin(x1) + 7.0 * sine * sine}, _ok(len(x))


_WEIGHTS = (0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0)


class GFunctionParameters(NamedTuple):
    """Inputs of the g-function of Sobol'."""

    x1: Annotated[float, _input("x_1", 0.0, 1.0)] = 0.5
    x2: Annotated[float, _input("x_2", 0.0, 1.0)] = 0.5
    x3: Annotated[float, _input("x_3", 0.0, 1.0)] = 0.5
    x4: Annotated[float, _input("x_4", 0.0, 1.0)] = 0.5
    x5: Annotated[float, _input("x_5", 0.0, 1.0)] = 0.5
    x6: Annotated[float, _input("x_6", 0.0, 1.0)] = 0.5
    x7: Annotated[float, _input("x_7", 0.0, 1.0)] = 0.5
    x8: Annotated[float, _input("x_8", 0.0, 1.0)] = 0.5


def g_function(x: Array, seed: NDArray[np.uint64], settings: NoSettings) -> Result:
    """Evaluate y = product of (|4 x_i - 2| + a_i) / (1 + a_i), a = 0, 1, 4.5, 9, 99, 99, 99, 99.

    With independent inputs uniform on [0, 1], the mean is 1, the partial variances are
    V_i = 1/(3 (1 + a_i)^2), the variance V = product of (1 + V_i) - 1, and S_i = V_i / V,
    ST_i = V_i product over j != i of (1 + V_j) / V.

    Parameters
    ----------
    x : ndarray, shape (n, 8)
        [1]
    seed : ndarray, shape (n,)
        Not used.
    settings : NoSettings

    Returns
    -------
    outputs : dict
        ``y``, shape (n,) [1].
    status : ndarray, shape (n,)

    References
    ----------
    A. Saltelli, I. M. Sobol', "About the use of rank transformation in sensitivity analysis of
    model output", Reliab. Eng. Syst. Saf. 50, 225-239 (1995).
    """
    y = np.ones(len(x))
    for column, a in zip(_columns(x), _WEIGHTS, strict=True):
        y *= (np.abs(4.0 * column - 2.0) + a) / (1.0 + a)
    return {"y": y}, _ok(len(x))


class LinearParameters(NamedTuple):
    """Inputs of the linear function."""

    x1: Annotated[float, _input("x_1", 0.0, 1.0)] = 0.5
    x2: Annotated[float, _input("x_2", 0.0, 1.0)] = 0.5
    x3: Annotated[float, _input("x_3", 0.0, 1.0)] = 0.5
    x4: Annotated[float, _input("x_4", 0.0, 1.0)] = 0.5


@dataclass(frozen=True)
class LinearSettings:
    """Faults on request, injected as ordinary settings."""

    fail_above: Annotated[float, Setting("rows with x1 above this fail")] = 2.0
    fail_how: Annotated[
        str,
        Setting("how those rows fail", choices=("nan", "inf", "raise", "shape", "exit", "hang")),
    ] = "nan"


def linear(x: Array, seed: NDArray[np.uint64], settings: LinearSettings) -> Result:
    """Evaluate y = x1 + 2 x2 + 3 x3 + 4 x4, and fail on request.

    A row that fails by ``exit`` ends the process at once; one that fails by ``hang`` never returns.

    With independent inputs uniform on [0, 1], the mean is 5, the variance 30/12, and
    S_i = ST_i = i^2/30.

    Parameters
    ----------
    x : ndarray, shape (n, 4)
        [1]
    seed : ndarray, shape (n,)
        Not used.
    settings : LinearSettings

    Returns
    -------
    outputs : dict
        ``y``, shape (n,) [1]; one element too many if a row is to fail by ``shape``.
    status : ndarray, shape (n,)

    Raises
    ------
    ValueError
        If a row is to fail by ``raise``.
    """
    x1, x2, x3, x4 = _columns(x)
    y = x1 + 2.0 * x2 + 3.0 * x3 + 4.0 * x4
    failing = x1 > settings.fail_above
    if failing.any():
        match settings.fail_how:
            case "raise":
                raise ValueError(f"x1 is above fail_above = {settings.fail_above}")
            case "shape":
                y = np.append(y, 0.0)
            case "exit":
                os._exit(1)
            case "hang":
                while True:
                    time.sleep(1.0)
            case word:
                y[failing] = float(word)
    return {"y": y}, _ok(len(x))


class ExponentialWearParameters(NamedTuple):
    """Inputs of wear at a constant rate."""

    rate: Annotated[
        float,
        Parameter("r", "m s-1", "growth of the wear depth", (0.0, 1e6), "assumed: 8 mm in a year"),
    ] = 2.5e-10
    depth: Annotated[
        float, Parameter("d", "m", "depth that ends the life", (0.0, 1e6), "assumed")
    ] = 2.5e-4
    threshold: Annotated[
        float, Parameter("r_0", "m s-1", "slower wear counts as none", (0.0, 1e6), "assumed")
    ] = 0.0


def exponential_wear(x: Array, seed: NDArray[np.uint64], settings: NoSettings) -> Result:
    """Evaluate life = depth/rate; never (+inf) where rate < threshold or rate = 0.

    A lognormal rate gives a lognormal life; an exponential depth (gamma or weibull of shape 1) an
    exponential one.

    Parameters
    ----------
    x : ndarray, shape (n, 3)
        rate [m s-1], depth [m], threshold [m s-1].
    seed : ndarray, shape (n,)
        Not used.
    settings : NoSettings

    Returns
    -------
    outputs : dict
        ``life``, shape (n,) [s].
    status : ndarray, shape (n,)
    """
    rate, depth, threshold = _columns(x)
    wears = (rate >= threshold) & (rate > 0.0)
    life = np.full(len(x), np.inf)
    with np.errstate(over="ignore"):  # a life beyond the largest float is never, too
        np.divide(depth, rate, out=life, where=wears)
    return {"life": life}, _ok(len(x))


def _model(name: str, title: str, parameters: Any, batch: Any, **more: Any) -> Model:
    declared: dict[str, Any] = {
        "settings": NoSettings,
        "outputs": {"y": Output("1", "value of the function")},
        "block": 1024,
    }
    return Model(
        name=name,
        title=title,
        version="1",
        parameters=parameters,
        batch=batch,
        **(declared | more),
    )


ISHIGAMI = _model(
    "ishigami",
    "Ishigami function: strong interaction, known Sobol' indices",
    IshigamiParameters,
    ishigami,
    references=("Ishigami and Homma, ISUMA '90, 398-403 (1990)",),
)
G_FUNCTION = _model(
    "g-function",
    "Sobol' g-function of eight inputs, known indices of every order",
    GFunctionParameters,
    g_function,
    references=("Saltelli and Sobol', Reliab. Eng. Syst. Saf. 50, 225-239 (1995)",),
)
LINEAR = _model(
    "linear",
    "Linear function that fails on request",
    LinearParameters,
    linear,
    settings=LinearSettings,
)
EXPONENTIAL_WEAR = _model(
    "exponential-wear",
    "Wear at a constant rate: known distribution of the life",
    ExponentialWearParameters,
    exponential_wear,
    outputs={
        "life": Output(
            "s",
            "time until the depth is reached",
            kind="lifetime",
            may_be_censored=False,
            scales={"depth": 1.0},
        )
    },
)
