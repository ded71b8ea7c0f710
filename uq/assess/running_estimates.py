"""Running estimates, each with the numbers of samples that it comes from."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import pandas as pd

from uq.assess.convergence import enough, running_estimates
from uq.result.result import Result
from uq.stats.estimate import Estimate

Sizes = list[tuple[int, Estimate]]
"""Number of samples, and the estimate from them."""


class Converging(NamedTuple):
    """Running estimates of one output, or of its transform.

    Attributes
    ----------
    estimates : dict of str to list
        Label -> its `Sizes`.
    errors : dict or None
        Its line of `uq.enough`, if it has one.
    """

    estimates: Mapping[str, Sizes]
    errors: Mapping[Any, Any] | None


def converging(result: Result, output: str | None = None) -> dict[str, Converging]:
    """Return the running estimates of a result by output and label.

    Parameters
    ----------
    result : Result
    output : str, optional
        As for `uq.running_estimates`.
    """
    running, errors = running_estimates(result, output), enough(result, output).to_dict("index")
    return {
        str(name): Converging(
            {str(label): _by_size(group) for label, group in lines.groupby("estimate", sort=False)},
            errors.get(name),
        )
        for name, lines in running.groupby("output", sort=False)
    }


def _by_size(lines: pd.DataFrame) -> Sizes:
    columns = (lines[name].tolist() for name in ("samples", "value", "low", "high"))
    return [(samples, Estimate(*numbers)) for samples, *numbers in zip(*columns, strict=True)]
