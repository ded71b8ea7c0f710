"""Estimates from growing numbers of rows, and the sampling error beside other errors."""

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from uq.assess.fact import Fact, Functions
from uq.assess.sensitivities import sensitivities
from uq.assess.statistic import Reader
from uq.assess.statistics.counts import stated_error
from uq.assess.statistics.table import STATISTICS
from uq.assess.summary import Described, Summary, summarise
from uq.assess.targets import split_name
from uq.errors import InputError
from uq.indices.methods import METHODS, indices_of, piloted_by
from uq.result.element import Element
from uq.result.result import AnyResult, Result
from uq.result.variables import is_error
from uq.sampling.designs import DESIGNS
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.text.element_names import is_whole, whole_name

COLUMNS = ["output", "estimate", "samples", "value", "low", "high", "kind", "input"]

_FEWEST = 16  # samples

_RUNNING = tuple(name for name in STATISTICS if name not in ("b_lives", "causes", "integrated"))
"""Statistics that are estimated from growing numbers of rows."""


def running_estimates(result: AnyResult, output: str | None = None) -> pd.DataFrame:
    """Estimate everything from the first samples of a result, in increasing numbers.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str, optional
        Only this output, or this element of one.

    Returns
    -------
    pandas.DataFrame
        Columns ``output`` (its element), ``estimate`` (``mean``, ``quantile 0.5``, ``P(>t)``,
        ``P(<t)``, and ``S1 x``, ``ST x`` for a crossed design), ``samples``, ``value``, ``low``,
        ``high``; of an index also its ``kind`` and ``input``, elsewhere "". Sizes double up to the
        whole result. The intervals are pointwise.

    Raises
    ------
    InputError
        When there is no such output, or the first rows of the design are not a smaller one.

    Examples
    --------
    >>> ds = uq.run("studies/exponential-wear.toml")
    >>> running = uq.running_estimates(ds)
    >>> running[running["estimate"] == "mean"]["samples"].to_list()
    [16, 32, 63, 125, 250, 500, 1000]
    """
    return running_table(Result.of(result), output)


def running_table(
    result: Result, output: str | None = None, summary: Summary | None = None
) -> pd.DataFrame:
    """Return `running_estimates`; a `summary` of all rows is not computed again."""
    lines = [
        (line.output, line.label, samples, *line.estimate.numbers, line.kind, line.input)
        for samples, line in running(result, output, summary)
    ]
    return pd.DataFrame(lines, columns=COLUMNS)


class RunningEstimate(NamedTuple):
    """An estimate from the first rows of a result.

    Attributes
    ----------
    output, label : str
    estimate : Estimate
    by : tuple of callable
        The functions that compute it.
    rows : Result
        The rows that suffice to compute it again.
    kind, input : str
        Of an index; "" elsewhere.
    """

    output: str
    label: str
    estimate: Estimate
    by: Functions
    rows: Result
    kind: str = ""
    input: str = ""


def running(
    result: Result, output: str | None = None, summary: Summary | None = None
) -> Iterator[tuple[int, RunningEstimate]]:
    """Yield the lines of `running_estimates`: number of samples, estimate from them."""
    result.refuse_if_weighted("running estimates")
    names = None
    if output is not None:
        whole = output if is_whole(output) else whole_name(output)
        names = {whole, *(element.name for element in result.named_elements(output))}
    # Those of all rows: of the first ones alone a life may have another target.
    targets = (
        list(sensitivities(result, method).targets) if (method := method_shown(result)) else []
    )
    for samples in _sizes(result):
        rows = result.first_samples(samples)
        of_all = summary if len(rows) == len(result) else None
        for line in estimates_from(rows, targets, of_all):
            if names is None or split_name(line.output)[1] in names:
                yield samples, line


def enough(result: AnyResult, output: str | None = None) -> pd.DataFrame:
    """Compare the error of sampling with the errors of the rows themselves.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str, optional
        Only this output, or this element of one.

    Returns
    -------
    pandas.DataFrame
        Index: element of an output. ``estimate``, its mean or, where rows never end or are
        censored or the tail is heavy, its median; ``sampling``, the half-width of its interval;
        ``own``, the mean magnitude of ``<output>_error``, the error of solver and time averages
        that the model gives for each row (NaN where it gives none): the error of the estimate if
        all of them had the same sign; ``warning``, not empty where `own` is the larger: then more
        rows do not help.
    """
    return errors_of(Result.of(result), output)


def errors_of(
    result: Result, output: str | None = None, outputs: Mapping[str, Described] | None = None
) -> pd.DataFrame:
    """Return `enough`; statistics of the `outputs` of all rows are not computed again."""
    result.refuse_if_weighted("the error of sampling")
    if outputs is None:
        outputs = summarise(result, parts=("moments", "quantiles")).outputs
    names = result.output_names
    rows = result.independent
    plain = [name for name in names if not is_error(name, names)]
    lines = {}
    for element in rows.named_elements(output) if output else rows.elements(plain):
        if element.name not in outputs:
            continue
        lines[element.name] = compared(rows, element, outputs[element.name])
    columns = ["estimate", "sampling", "own", "warning"]
    return pd.DataFrame(
        list(lines.values()), index=pd.Index(list(lines), name="output"), columns=columns
    )


class Errors(NamedTuple):
    """Sampling error and numerical error of the rows, as `enough` returns them."""

    estimate: str
    sampling: float
    numerical: float
    warning: str


def compared(result: Result, element: Element, described: Described) -> Errors:
    """Compare the sampling error of an element with the numerical error of the rows.

    Parameters
    ----------
    result : Result
        The independent rows of a result.
    element : Element
    described : Described
        Its statistics.
    """
    label, statistic = "mean", described.find("mean")
    if statistic is None or np.isnan(statistic.estimate.value) or statistic.estimate.reason:
        label, statistic = "median", described.find("quantiles", "0.5")
    has_interval = statistic is not None and statistic.estimate.has_interval
    sampling = (
        (statistic.estimate.high - statistic.estimate.low) / 2
        if statistic and has_interval
        else np.nan
    )
    error = stated_error(result, element)
    sizes = np.abs(error.values[np.isfinite(error.values)]) if error else np.empty(0)
    numerical = float(sizes.mean()) if len(sizes) else np.nan
    words = _WARNING.format(numerical=numerical, units=element.units, sampling=sampling)
    return Errors(label, sampling, numerical, words if numerical > sampling else "")


_WARNING = (
    "numerical error ({numerical:.3g} {units}) exceeds sampling error ({sampling:.3g}): more rows"
    " do not help, finer settings or longer averages do"
)


def _sizes(result: Result) -> list[int]:
    method, size = result.design_name, int(result.dataset.attrs["samples"])
    if not (DESIGNS[method].append_only or result.has_independent_rows):
        able = " or ".join(f"'{name}'" for name, design in DESIGNS.items() if design.append_only)
        raise InputError(
            f"the first rows of design '{method}' are not a smaller one, so there are no"
            f" estimates from fewer samples; use {able}"
        )
    sizes = [size]
    while (size := -(-size // 2)) >= _FEWEST:
        sizes.append(size)
    return sizes[::-1]


def method_shown(result: Result) -> str | None:
    """Return the method whose indices are estimated from the first rows, if they suffice."""
    groups = len(np.unique(result.dataset["group"])) * result.dataset.attrs["replicates"]
    name = piloted_by(result.design)
    return name if name and groups >= METHODS[name].least else None


def estimates_from(
    result: Result, targets: list[str], summary: Summary | None = None
) -> Iterator[RunningEstimate]:
    """Yield the statistics of some rows, from their summary if given, and indices of targets."""
    summary = summary or summarise(result, parts=_RUNNING)
    for name, output in summary.outputs.items():
        for statistic in output.statistics:
            if statistic.is_read_by(Reader.RUNNING):
                estimate = statistic.estimate.finite
                yield RunningEstimate(name, statistic.label, estimate, statistic.by, summary.rows)
    if method := method_shown(result):
        for name, target_indices in sensitivities(result, method, targets).targets.items():
            for kind, values in target_indices.kinds().items():
                by = (partial(indices_of, method, kind.key),)
                for label, index in values.items():
                    words = f"{kind.key} {label}"
                    yield RunningEstimate(name, words, index, by, result, kind.key, label)


Sizes = list[tuple[int, RunningEstimate]]
"""Number of samples, and the estimate from them."""

Converging = tuple[dict[str, Sizes], Mapping[Any, Any] | None]
"""Estimates of an output, or of its transform, by label; its line of `uq.enough`, if it has one."""


def converging(result: Result, output: str | None = None) -> dict[str, Converging]:
    """Return the running estimates of a result by output and label.

    Parameters
    ----------
    result : Result
    output : str, optional
        As for `uq.running_estimates`.
    """
    estimates = dict[str, dict[str, Sizes]]()
    for samples, line in running(result, output):
        estimates.setdefault(line.output, {}).setdefault(line.label, []).append((samples, line))
    errors = enough(result, output).to_dict("index")
    return {name: (by_label, errors.get(name)) for name, by_label in estimates.items()}


def convergence_facts(outputs: Mapping[str, Converging]) -> Fact:
    """Return running estimates, and the errors of all rows."""
    members = {}
    for name, (estimates, errors) in outputs.items():
        facts = {
            label: [running_fact(*size) for size in sizes] for label, sizes in estimates.items()
        }
        members[name] = {"estimates": facts} | errors_facts(errors)
    return Fact({"outputs": members})


def running_fact(samples: int, line: RunningEstimate) -> Fact:
    """Return the estimate from a number of samples."""
    members = {"samples": samples} | estimate_json.numbers(line.estimate)
    return Fact(members, line.by, rows=line.rows)


def errors_facts(errors: Mapping[Any, Any] | None) -> dict[str, Any]:
    """Return a line of `uq.enough`; nothing without one."""
    if not errors:
        return {}
    return {
        "sampling_error": Fact(estimate_json.number(errors["sampling"]), (enough,)),
        "own_error": Fact(estimate_json.number(errors["own"]), (enough,)),
        "warning": errors["warning"],
    }
