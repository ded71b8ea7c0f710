"""The numbers of `uq summary` and their origins."""

from collections.abc import Callable
from typing import Any

from uq.assess.life_fit import fits_of
from uq.assess.regime_boundary import BOUNDARY, boundary, boundary_json, compared_rows
from uq.assess.statistic import Reader, Statistic
from uq.assess.statistics.table import STATISTICS
from uq.assess.summary import REGIME, Described, Summary, status_counts, summarise
from uq.assess.summary_json import put, summary_json, written
from uq.render.trace.citations import cited
from uq.render.trace.origin import Origin, rows_behind
from uq.result.elements import Element, independent_rows
from uq.result.result import Result
from uq.stats.importance_weights import effective_rows, tail_shape
from uq.stats.uncertainty_exponent import uncertainty_exponent
from uq.text.keys import Json, Options, Path

COUNTED = ("failed", "undefined", "censored", "never")

WEIGHTS = {"effective_rows": effective_rows, "pareto_k": tail_shape}
"""Quality of weighted rows -> its estimator."""

Functions = tuple[Callable[..., Any], ...]


def json_of(result: Result, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of a summary, with the statistics that only the report shows.

    Parameters
    ----------
    result : Result
        A result, or the rows that a number rests on.
    options : dict of str to str
        ``regime``.
    path : tuple of str
        If it names an output, no others are described; laws are fitted if it asks for ``fits``.

    Returns
    -------
    dict
    """
    summary = _summary_of(result, options, path)
    whole = summary_json(summary)
    if path[:1] == (BOUNDARY,):
        whole |= boundary_json(boundary(result))
    for name, described in summary.outputs.items():
        others = [
            statistic for statistic in described.statistics if not statistic.is_read_by(Reader.JSON)
        ]
        for parent, _, entry in written(others):
            put(whole["outputs"][name], parent, entry)
    return whole


def origin(result: Result, options: Options, path: Path, document: Json) -> Origin:
    """Return the origin of a number of a summary."""
    if regime := options.get("regime"):
        result = result.within_regime(regime)
    if path[0] in ("samples", "status"):
        return Origin((cited(status_counts),), result)
    rows = rows_behind(result)
    if path[0] == "rows_used":
        return Origin((cited(independent_rows),), rows)
    if path[0] == BOUNDARY:
        return Origin((cited(uncertainty_exponent),), compared_rows(result))
    if path[0] in WEIGHTS:
        return Origin((cited(WEIGHTS[path[0]]),), rows)
    return summary_origin(_summary_of(result, {}, path), rows, path)


def summary_origin(summary: Summary, rows: Result, path: Path) -> Origin:
    """Return the origin of a share of a category or a number of an output.

    Parameters
    ----------
    summary : Summary
    rows : Result
        The rows that it describes.
    path : tuple of str
    """
    if path[0] in ("regime", "categories"):
        name, label = (REGIME, path[1]) if path[0] == REGIME else path[1:3]
        return Origin(tuple(map(cited, summary.shares[name][label].by)), rows)
    states = states_of(rows.named_elements(path[1])[0])
    by = (fits_of,) if path[2] == "fits" else functions_of(summary.outputs[path[1]], path[2:])
    notes = () if summary.rows_used else tuple(summary.notes)  # why no row is used
    return Origin(tuple(map(cited, by)), rows, states, notes)


def states_of(element: Element) -> dict[str, int]:
    """Return how many rows of an element have a value, failed, are censored and so on."""
    counts = {name: int(getattr(element, name).sum()) for name in COUNTED}
    nonzero = {name: count for name, count in counts.items() if count}
    return {"with a value": int(element.present.sum())} | nonzero


def _summary_of(result: Result, options: Options, path: Path) -> Summary:
    names, output = result.output_names, _output(path)
    if path[:1] == ("categories",):
        output = path[1].partition("[")[0] if path[1:] else ""
    elif path and path[0] != "outputs":
        output = next(iter(names))  # counts and regimes need no output
    analysis = result.analysis_of(output if output in names else None)
    return summarise(result, analysis, regime=options.get("regime"), fits="fits" in path)


def functions_of(described: Described, path: Path) -> Functions:
    """Return the estimators of the number at a path in the JSON of an element."""
    for name, statistics in described.parts.items():
        for parent, members, entry in written(statistics):
            rest = path[len(parent) :]
            if path[: len(parent)] == parent and (not rest or rest[0] in entry):
                meant = [statistic for statistic in members if _means(statistic, rest)] or members
                chosen = [_under_assumption(statistic, rest) for statistic in meant]
                by = [
                    function
                    for statistic in chosen
                    for function in statistic.by or (STATISTICS[name],)
                ]
                return tuple(dict.fromkeys(by))
    return (STATISTICS[path[0]],)  # the study does not ask for it


def _means(statistic: Statistic, rest: Path) -> bool:
    last = statistic.key[-1]
    return any(part == last or part.startswith(f"{last}_") for part in rest)


def _under_assumption(statistic: Statistic, rest: Path) -> Statistic:
    return (
        statistic.otherwise
        if statistic.otherwise is not None and "kaplan_meier" in rest
        else statistic
    )


def _output(path: Path) -> str:
    """Return the output whose element a path names, or ""."""
    return path[1].partition("[")[0] if path[:1] == ("outputs",) and path[1:] else ""
