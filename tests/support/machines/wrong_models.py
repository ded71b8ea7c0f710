"""Models that break their contract: wrong names, types, shapes, categories, inputs overwritten."""

from dataclasses import replace

import numpy as np
from sample_models import ok, simple

from uq.contract import Output

WRONG_NAME = simple("wrong-name", lambda x, seed, settings: ({"z": x[:, 0]}, ok(len(x))))
WRONG_DTYPE = simple(
    "wrong-dtype", lambda x, seed, settings: ({"y": x[:, 0].astype(np.float32)}, ok(len(x)))
)
WRONG_SHAPE = simple("wrong-shape", lambda x, seed, settings: ({"y": x.copy()}, ok(len(x))))
WRONG_STATUS = simple(
    "wrong-status", lambda x, seed, settings: ({"y": x[:, 0].copy()}, ok(len(x)) + np.int8(99))
)
NO_TUPLE = simple("no-tuple", lambda x, seed, settings: {"y": x[:, 0].copy()})
A_LIST = simple("a-list", lambda x, seed, settings: ({"y": list(x[:, 0])}, ok(len(x))))
WRONG_CATEGORY = replace(
    simple(
        "wrong-category", lambda x, seed, settings: ({"y": ok(len(x)) + np.int8(2)}, ok(len(x)))
    ),
    outputs={"y": Output("1", "kind", kind="category", categories=("a", "b"))},
)


def _mutating(x, seed, settings):
    y = x[:, 0].copy()
    x[:] = -1.0
    return {"y": y}, ok(len(x))


MUTATING = simple("mutating", _mutating)
"""Writes into its input."""
