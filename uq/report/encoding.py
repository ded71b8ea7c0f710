"""Numbers as text, for the scripts of a page."""

import base64
from typing import Any

import numpy as np


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
