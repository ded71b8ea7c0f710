"""Arrays as text inside a page: base64 of their bytes."""

import base64
from typing import Any

import numpy as np

from uq.contract import Floats

IMPOSSIBLE = 255
"""The byte of a row without weight."""

_STEPS = 254
_ALIKE = 1e-9  # differences of logarithms that are rounding
_DEEPEST = 16.0
"""Largest fall of a logarithm that is kept: less than a ten millionth of the largest weight is
negligible."""


def encoded(values: Any, kind: str) -> str:
    """Return an array as base64 of its bytes.

    Parameters
    ----------
    values : array-like
    kind : str
        NumPy's name of their type, such as ``"<f8"``.

    Returns
    -------
    str
    """
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()


def log_bytes(weights: Floats) -> dict[str, Any]:
    """Return the logarithms of weights as one byte each.

    Parameters
    ----------
    weights : ndarray, shape (n,)
        Not all 0.

    Returns
    -------
    dict
        The logarithm is ``top - step * byte``, or -inf where the byte is `IMPOSSIBLE`.
    """
    possible = weights > 0
    logs = np.log(weights, where=possible, out=np.full(len(weights), -np.inf))
    top = float(logs.max())
    depth = np.minimum(top - logs, _DEEPEST)
    step = max(float(depth[possible].max()) / _STEPS, _ALIKE)
    codes = np.where(possible, np.round(depth / step), IMPOSSIBLE)
    return {"top": top, "step": step, "bytes": encoded(codes, "u1")}
