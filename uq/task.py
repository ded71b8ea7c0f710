"""What a worker process is asked to do: plain data in, plain data out.

Apart from the rest, so that a worker imports no more than the model and what runs it.
"""

import time
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.errors import InputError
from uq.evaluate import Chunk, evaluate
from uq.registry import find_model

_find_model = cache(find_model)


def evaluate_rows(
    reference: str,
    version: str,
    settings: dict[str, Any],
    x: NDArray[np.float64],
    seed: NDArray[np.uint64],
    start: int,
) -> tuple[Chunk, float]:
    """Run some rows in a worker process, and say how many seconds that took.

    One dask task, given plain data only: a worker that lacks the model would not survive the
    arrival of one of its objects.
    """
    model = _find_model(reference)
    if model.version != version:
        raise InputError(
            f"a worker has version {model.version} of model '{model.name}', "
            f"this process has {version}: install the same on both"
        )
    began = time.perf_counter()
    chunk = evaluate(model, model.settings(**settings), x, seed, start)
    return chunk, time.perf_counter() - began
