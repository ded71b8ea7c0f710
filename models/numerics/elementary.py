"""Elementary functions of arrays, element by element.

numpy's own are vectorised for each processor and differ in the last bit. These are the C library's;
sine and cosine are our own.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from models.numerics.jit import kernel
from models.numerics.sincos import cosine_sine


@kernel
def _exp(x, out):
    for i in range(len(x)):
        out[i] = math.exp(x[i])


@kernel
def _expm1(x, out):
    for i in range(len(x)):
        out[i] = math.expm1(x[i])


@kernel
def _log(x, out):
    for i in range(len(x)):
        out[i] = math.log(x[i]) if x[i] != 0 else -math.inf


@kernel
def _log1p(x, out):
    for i in range(len(x)):
        out[i] = math.log1p(x[i])


@kernel
def _cos(x, out):
    for i in range(len(x)):
        out[i], _ = cosine_sine(x[i])


@kernel
def _sin(x, out):
    for i in range(len(x)):
        _, out[i] = cosine_sine(x[i])


def _each(function: Any, x: ArrayLike) -> Any:
    x = np.asarray(x, float)
    out = np.empty(x.size)
    function(np.ravel(x), out)
    return out.reshape(x.shape)


def exp(x: ArrayLike) -> Any:
    """Return exp(x), in the shape of x."""
    return _each(_exp, x)


def expm1(x: ArrayLike) -> Any:
    """Return exp(x) - 1."""
    return _each(_expm1, x)


def log(x: ArrayLike) -> Any:
    """Return log(x) for x >= 0, in the shape of x."""
    return _each(_log, x)


def log1p(x: ArrayLike) -> Any:
    """Return log(1 + x) for x >= -1."""
    return _each(_log1p, x)


def cos(x: ArrayLike) -> Any:
    """Return the cosines of angles [rad], in the shape of x."""
    return _each(_cos, x)


def sin(x: ArrayLike) -> Any:
    """Return the sines of angles [rad], in the shape of x."""
    return _each(_sin, x)
