"""Origin of one number of a result, the rows behind it, and its recomputation."""

import inspect
import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from uq.errors import InputError
from uq.indices.methods import METHODS, indices_of
from uq.render.trace.verbs import VERBS
from uq.result.elements import flags
from uq.result.result import AnyResult, Result
from uq.study.provenance import provenance
from uq.text.keys import key_of, no_such_key, numbers_in, paths_of_numbers, taken_apart
from uq.text.numbers import counted


class Citation(NamedTuple):
    """Citation of an estimator.

    Attributes
    ----------
    does : str
        One-line summary.
    code : str
        Function that computes it: ``uq.stats.order_statistics.quantile``.
    sources : tuple of str
        References of its docstring.
    """

    does: str
    code: str = ""
    sources: tuple[str, ...] = ()


def cited(function: Callable[..., Any]) -> Citation:
    """Return the summary and references in the docstring of an estimator or of its method."""
    if isinstance(function, partial) and function.func is indices_of:
        return _of_index(*function.args)
    while isinstance(function, partial):
        function = function.func
    docstring = inspect.getdoc(function) or ""
    first = _joined(docstring.split("\n\n")[0])
    section = re.search(
        r"^References\n-+\n(.*?)(?=^\w+\n-+$|\Z)", docstring, re.DOTALL | re.MULTILINE
    )
    entries = re.split(r"^\.\. (?=\[\d+\] )", section[1], flags=re.MULTILINE) if section else []
    code = f"{function.__module__}.{getattr(function, '__qualname__', '')}"
    return Citation(first.removesuffix("."), code, tuple(filter(None, map(_joined, entries))))


def _of_index(method: str, key: str) -> Citation:
    """Return question, estimator and references of a method; with key "", of no kind of index."""
    estimator = METHODS[method]
    kinds = [f" ({kind.words})" for kind in estimator.kinds if kind.key == key]
    code = f"uq.indices.methods.METHODS['{method}']"
    references = [estimator.source, estimator.intervals and f"intervals: {estimator.intervals}"]
    sources = (*filter(None, references), *cited(estimator.estimate).sources)
    return Citation(f"{estimator.question}{''.join(kinds)}", code, sources)


def _joined(text: str) -> str:
    """Return text on one line, with ``[1]`` for the mark ``[1]_``."""
    return re.sub(r"(\[\d+\])_", r"\1", " ".join(text.split()))


class Run(NamedTuple):
    """Equally spaced rows in one block of the design."""

    block: str
    first: int
    last: int
    step: int
    rows: int

    @property
    def words(self) -> str:
        """Row numbers in words."""
        if self.rows == 1:
            return f"{self.first}"
        by = f" by {self.step}" if self.step > 1 else ""
        return f"{self.first} to {self.last}{by}"


def runs_of(rows: Result) -> list[Run]:
    """Return the numbers of rows as runs, block by block."""
    numbers, blocks = rows.dataset["row"].values, rows.dataset["block"].values
    return [
        Run(label, *run)
        for code, label in flags(rows.dataset["block"])
        for run in _runs(np.sort(numbers[blocks == code]))
    ]


def _runs(numbers: NDArray[np.int64]) -> list[tuple[int, int, int, int]]:
    """Split ascending numbers where their spacing changes."""
    if len(numbers) == 0:
        return []
    steps = np.diff(numbers)
    usual = int(np.median(steps)) if len(steps) else 1
    parts = np.split(numbers, np.flatnonzero(steps != usual) + 1)
    return [(int(run[0]), int(run[-1]), usual, len(run)) for run in parts]


def in_words(runs: list[Run], most: int = 4) -> str:
    """Return runs in words: ``blocks A and B: 0 to 630 by 5, 4 to 634 by 5``."""
    blocks = list(dict.fromkeys(run.block for run in runs))
    shown = ", ".join(run.words for run in runs[:most])
    if len(runs) > most:
        shown += f" and {counted(len(runs) - most, 'more run')}"
    if blocks == ["sample"] or not blocks:
        return shown
    named = ", ".join(blocks[:most]) + (f" and {len(blocks) - most} more" if blocks[most:] else "")
    return f"block{'s' * (len(blocks) > 1)} {named}: {shown}"


RECORDED = ("source", "design", "samples", "replicates", "seed", "study_sha256", "study_identity")
"""Attributes of a result that record how its rows were drawn."""


@dataclass(frozen=True)
class Trace:
    """Origin of a number, and its recomputation.

    Attributes
    ----------
    key : str
    path : tuple of str
        In the JSON of its verb.
    numbers, again : dict
        The number, or value, low and high of an estimate, and the same from the rows alone; null is
        None.
    estimators : tuple of Citation
    rows_used, rows : int
        Numbers of the rows behind it, and of all rows.
    runs : list of Run
        The rows behind it.
    states : dict of str to int
        Number of these rows with a value, failed and so on.
    notes : tuple of str
    recorded : dict
        Attributes of the design of the rows.
    versions : dict of str to str
        The code of the model, and the versions that computed the rows.
    versions_here : dict of str to str
        Versions that differ at the recomputation.
    """

    key: str
    path: tuple[str, ...]
    numbers: Mapping[str, Any]
    again: Mapping[str, Any]
    estimators: tuple[Citation, ...]
    rows_used: int
    rows: int
    runs: list[Run]
    states: Mapping[str, int]
    notes: tuple[str, ...]
    recorded: Mapping[str, Any]
    versions: Mapping[str, str]
    versions_here: Mapping[str, str]

    @property
    def equal(self) -> bool:
        """Whether the number and its recomputation are equal to the bit."""
        return json.dumps(self.numbers) == json.dumps(self.again)  # full precision

    @property
    def which(self) -> str:
        """Rows behind the number in words."""
        return in_words(self.runs)


def trace(result: AnyResult, key: str, model: str | None = None) -> pd.Series:
    """Return the provenance of a number of a result, and recompute it.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
    key : str
        Its path in the JSON of its verb, such as ``outputs/life/quantiles/0.05`` of ``uq summary``
        or ``sensitivity/outputs/y/S1/x1``.
    model : str, optional
        Where a model that is not installed lives; only for numbers of ``uq twin``.

    Returns
    -------
    pandas.Series
        The number, ``value``, with ``low`` and ``high`` where it has an interval; ``equal``,
        whether the same number follows from the rows that it names alone; estimator, source, rows,
        seed, code, versions.

    Raises
    ------
    InputError
        When there is no such key: the line names the nearest one.

    Examples
    --------
    >>> ds = uq.run("studies/ishigami.toml")
    >>> record = uq.trace(ds, "outputs/y/quantiles/0.5")
    >>> bool(record["value"] == uq.summary(ds).loc["y", "q0.5"]), record["equal"]
    (True, True)
    """
    entries = trace_json(traced(Result.of(result), key, model))
    return pd.Series(entries, dtype=object, name=entries.pop("key"))


def traced(result: Result, key: str, model: str | None = None) -> Trace:
    """Return the provenance of a number of a result; see `trace`."""
    parts = taken_apart(key.strip(), {name: verb.options for name, verb in VERBS.items()})
    verb, path = VERBS[parts.verb], parts.path
    options = parts.options | ({"model": model} if model else {})
    numbers = {}
    try:
        facts = verb.facts(result, options, path)
        place = facts.at(*path)
        numbers = numbers_in(place.json)
    except (KeyError, InputError):  # no such output
        pass
    if not path or not numbers:
        raise no_such_key(parts, verb.facts(result, options, ()).json, VERBS)
    rows = result if place.rows is None else place.rows
    again = (
        verb.again(rows, options, path)
        if verb.again
        else verb.facts(rows, options, path).at(*path).json
    )
    attrs = result.dataset.attrs
    return Trace(
        key_of(*path, verb=parts.verb, options=parts.options),
        path,
        numbers,
        numbers_in(again),
        tuple(dict.fromkeys(map(cited, place.by))),
        len(rows),
        len(result),
        runs_of(rows),
        {} if place.rows is None else verb.states(rows, facts, path),
        place.notes,
        {name: _plain(attrs[name]) for name in RECORDED if name in attrs},
        {name: str(attrs[name]) for name in ("code", *provenance()) if name in attrs},
        {name: now for name, now in provenance().items() if attrs.get(name) != now},
    )


def keys_of(result: Result, begin: str = "") -> list[str]:
    """Return the keys of the numbers of the verb with which a key begins."""
    verb, options, _ = taken_apart(begin, {name: verb.options for name, verb in VERBS.items()})
    whole = VERBS[verb].facts(result, options, ()).json
    return [key_of(*path, verb=verb, options=options) for path in paths_of_numbers(whole)]


def trace_json(record: Trace) -> dict[str, Any]:
    """Return a trace in plain data.

    Returns
    -------
    dict
        ``key``; the number, ``value``, or what its estimate consists of; ``equal`` and ``again``;
        ``estimators``, each what it ``does``, its ``code`` and ``sources``; ``rows``: ``used``,
        ``of``, ``which`` (runs), and how many have a value, failed and so on; ``notes``; how the
        rows were drawn (``seed`` and more); ``versions``, and ``versions_here`` that differ.
    """
    which = [run._asdict() for run in record.runs]
    return {
        "key": record.key,
        **record.numbers,
        "equal": record.equal,
        "again": dict(record.again),
        "estimators": [citation._asdict() for citation in record.estimators],
        "rows": {
            "used": record.rows_used,
            "of": record.rows,
            "which": which,
            "states": dict(record.states),
        },
        "notes": list(record.notes),
        **record.recorded,
        "code": record.versions.get("code"),
        "versions": {name: made for name, made in record.versions.items() if name != "code"},
        "versions_here": dict(record.versions_here),
    }


def _plain(value: Any) -> Any:
    return value.item() if hasattr(value, "item") else value
