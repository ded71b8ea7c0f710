"""Statistics of a result under other laws of its inputs: the same rows, weighted."""

from collections.abc import Collection, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import lru_cache
from typing import Any

import pandas as pd

from uq.assess.fact import Fact
from uq.assess.reweighting import Weighting, changed_laws, depends_otherwise
from uq.assess.row_inputs import Inputs, inputs_of
from uq.assess.statistics.table import STATISTICS
from uq.assess.summary import Summary, summarise
from uq.assess.summary_facts import summary_facts
from uq.assess.summary_table import table_of
from uq.contract import Parameter
from uq.errors import InputError
from uq.result.result import AnyResult, Result
from uq.sampling.input_faults import InputFault
from uq.sampling.listed_values import Empirical
from uq.sampling.truncation import law_problem
from uq.stats.estimate_json import number
from uq.stats.importance_weights import ImportanceWeights, effective_rows, tail_shape
from uq.study.changes import change
from uq.study.file import AnalysisTable, StudyFile
from uq.study.input_checks import laws_in
from uq.study.reading import law_in_units, read_study_tables
from uq.text.literals import read_toml, shown
from uq.text.quantities import read_quantity

SAME = "what if: 'equals' cannot be changed"


@dataclass(frozen=True)
class WhatIf:
    """Summary of a result under other laws of its inputs.

    Attributes
    ----------
    summary : Summary
        Of the rows under the other laws.
    effective_rows : float
        The least number of equal rows that those of an output are worth.
    pareto_k : float
        Of the worst weights used.
    weights : ImportanceWeights
        Of the rows, with nothing integrated.
    """

    summary: Summary
    effective_rows: float
    pareto_k: float
    weights: ImportanceWeights


def what_if(result: AnyResult, changes: Mapping[str, Any]) -> pd.DataFrame:
    """Describe a result as if its inputs followed other laws, without computing a row.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    changes : dict of str to object
        Entries of the study file, such as ``{"uncertain.initial_gap.sd": 1e-5}`` or, for another
        law, ``{"uncertain.initial_gap": {"distribution": "normal", "mean": 2e-4, "sd": 1e-5}}``;
        or ``dependence.rank_correlation``, ``dependence.copula``, ``degrees_of_freedom`` and
        ``survival``.

    Returns
    -------
    pandas.DataFrame
        As `uq.summary`, of the outputs whose weights can be trusted, with ``effective_rows`` and
        ``pareto_k`` in its ``attrs``. An input that only scales lives is integrated: its law is
        replaced exactly. Rows have the ratio of densities as weights, smoothed [1]_.

    Raises
    ------
    InputError
        When the changes make no study, or one with values where the result has no rows, and these
        inputs do more than scale lives.
    RunError
        When the rows are too few for these laws; the message gives the number to add.

    References
    ----------
    .. [1] A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, "Pareto smoothed importance
       sampling", J. Mach. Learn. Res. 25, 72 (2024).
    """
    result = Result.of(result)
    answered = reweighted_summary(result, changes)
    table = table_of(answered.summary)
    table.attrs = {"effective_rows": answered.effective_rows, "pareto_k": answered.pareto_k}
    return table


def reweighted_summary(
    result: Result,
    changes: Mapping[str, Any],
    asked: AnalysisTable | None = None,
    parts: Collection[str] = STATISTICS,
) -> WhatIf:
    """Return the summary that `what_if` tabulates, or the requested part of it."""
    weighting = weighting_of(result, changes)
    summary = summarise(result, asked, weighting=weighting, parts=parts)
    weighting.refuse_if_unused()
    for name, weights in weighting.refused.items():
        summary.notes.append(f"{name}: {weights.refusal}")
    return WhatIf(summary, *weighting.quality, weighting.all_inputs)


def weighting_of(
    result: Result, changes: Mapping[str, Any], old: Inputs | None = None
) -> Weighting:
    """Return the weights of the independent rows of a result under other laws.

    Parameters
    ----------
    result : Result
    changes : dict of str to object
        As for `what_if`.
    old : Inputs, optional
        Inputs of these rows under the laws of the study, if already read.
    """
    result.refuse_if_weighted("what if")
    if why := result.why_no_statistics:
        raise InputError(f"what if: the rows of a '{result.design_name}' design {why}")
    rows = result.independent
    old, new = old or inputs_of(rows), _changed(rows, changes)
    _refuse(result, old, new)
    return Weighting(rows, old, new, rows.dependence)


def what_if_facts(answered: WhatIf) -> Fact:
    """Return the quality of the weights, and the numbers of the summary."""
    facts = summary_facts(answered.summary)
    counts = {name: facts.members[name] for name in ("samples", "rows_used", "status")}
    rows = facts.members["rows_used"].rows
    quality = {
        "effective_rows": Fact(answered.effective_rows, (effective_rows,), rows=rows),
        "pareto_k": Fact(number(answered.pareto_k), (tail_shape,), rows=rows),
    }
    weighted = Fact(quality | facts.members).each(
        lambda fact: replace(fact, by=fact.by and (what_if, *fact.by))
    )
    return replace(facts, members=weighted.members | counts)


def read_changes(texts: Sequence[str]) -> dict[str, Any]:
    """Read changes from the command line, such as ``uncertain.initial_gap.sd=1e-5``."""
    changes = {}
    for text in texts:
        name, equals, value = text.partition("=")
        name = name.strip()
        if name in changes:
            raise InputError(f"--set {shown(text)}: {name} is changed twice")
        try:
            if not (name and equals and value.strip()):
                raise ValueError
            changes[name] = _value(value.strip())
        except (ValueError, OverflowError, RecursionError):
            raise InputError(
                f"--set {shown(text)}: must be uncertain.NAME.KEY=VALUE, the value a number, a"
                " number with its unit, or TOML"
            ) from None
    return changes


def _value(text: str) -> Any:
    """Return a value: TOML, a quantity such as ``20 um``, or a word such as ``normal``."""
    try:
        return read_toml(f"x = {text}")["x"]
    except ValueError:
        if not text.replace("-", "_").isidentifier():
            read_quantity(text)
        return text


@lru_cache(maxsize=2)  # the sliders of a page change it a hundred times
def _parsed(text: str) -> dict[str, Any]:
    return read_toml(text)


def _changed(rows: Result, changes: Mapping[str, Any]) -> Inputs:
    """Return the inputs of the rows with the laws of the study as changed."""
    data = deepcopy(_parsed(rows.dataset.attrs["study"]))
    # Another copula first: it removes the options of the former one.
    for place, value in sorted(changes.items(), key=lambda entry: entry[0] != _COPULA):
        _put(data, place, value)
    for name in [name for name in data["uncertain"] if name in rows.dataset]:
        units = str(rows.dataset.variables[name].attrs["units"])
        misfits = law_in_units(data["uncertain"][name], name, units)
        if misfits:
            raise InputError(
                *(f"what if: {'.'.join(path)}: {why}" for path, why in misfits.items())
            )
    study = read_study_tables(data, "what if")
    inputs = inputs_of(rows, study, laws_in(data))
    faults = list(_faults(rows, study, inputs))
    if faults:
        raise InputError(*(f"what if: {fault.line}" for fault in faults))
    return inputs


_KEPT = ("source", "file", "times", "level")
_OF_MEASURED = ("", "distribution", "truncate", "source", "times", "level")
"""Entries of a law of measured values that may change, or that are refused for another reason."""


def changeable(laws: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return the entries of a table [uncertain] that a what-if can change: ``rate.sigma``."""
    return [
        f"{name}.{key}"
        for name, law in laws.items()
        for key in law
        if "equals" not in law and key not in _KEPT
        if law.get("distribution") != "empirical" or key in _OF_MEASURED
    ]


def _remedy(place: str, laws: Mapping[str, Mapping[str, Any]]) -> str:
    """Return what to write in place of an entry that cannot be changed."""
    entries = changeable(laws)
    numbers = [entry for entry in entries if not entry.endswith(".distribution")]
    inputs = [place] if place in laws else [name for name in laws if place in name.split("_")]
    meant = [entry for entry in numbers if entry.partition(".")[0] in inputs]
    meant = meant or [entry for entry in entries if entry == place or entry.endswith(f".{place}")]
    close = meant or get_close_matches(place, [*entries, *laws], n=1)
    if close:
        return "did you mean " + " or ".join(f"'uncertain.{entry}'" for entry in close) + "?"
    if place.partition(".")[0] in StudyFile.model_fields:
        return "it needs rows of its own: change it in a study, and run that"
    return (
        "only uncertain.NAME.KEY, uncertain.NAME, and rank_correlation, copula, degrees_of_freedom"
        " and survival of dependence can"
    )


_COPULA = "dependence.copula"
_CHANGED_IN = {
    "rank_correlation": "correlations",
    "copula": "copula",
    "degrees_of_freedom": "copula",
    "survival": "copula",
}


def _put(data: dict[str, Any], place: str, value: Any) -> None:
    table, _, rest = place.partition(".")
    if table == "dependence" and rest in _CHANGED_IN:
        if table not in data:
            raise InputError(
                f"what if: this study has no [dependence] whose {_CHANGED_IN[rest]} can change"
            )
        data[table][rest] = value
        if rest == "copula":  # the options of the former one
            data[table].pop("degrees_of_freedom", None)
            data[table].pop("survival", None)
        return
    name, _, argument = rest.partition(".")
    laws = data["uncertain"]
    if table != "uncertain" or not name:
        raise InputError(f"what if: '{place}' cannot be changed; {_remedy(place, laws)}")
    if name not in laws:
        problem = f"'{name}' is not uncertain in this study"
        raise InputError(f"what if: {problem}; {_remedy(rest, laws)}")
    if argument == "equals":
        raise InputError(SAME)
    is_measured = laws[name].get("distribution") == "empirical"
    is_value = not argument and not isinstance(value, Mapping)
    if is_measured and (is_value or argument not in _OF_MEASURED):
        raise InputError(_measured(name))
    if is_value:
        raise InputError(f"what if: '{name}' has a law, not a value; {_remedy(name, laws)}")
    change(data, place, value, "what if")


def _measured(name: str) -> str:
    """Return the refusal of other values than those measured."""
    return (
        f"what if: '{name}' has measured values, and the result no rows at others: change"
        f" 'uncertain.{name}.truncate', or run a study with the other law"
    )


def _faults(rows: Result, study: StudyFile, inputs: Inputs) -> list[InputFault]:
    faults = []
    for name, law in inputs.laws.items():
        about = rows.dataset.variables[name].attrs
        declared = Parameter("", about["units"], "", inputs.bounds[name], "")
        if law.times is None and (problem := law_problem(law, declared)):
            faults.append(problem.within("uncertain", name))
    if study.dependence is not None:
        if wrong := study.dependence.fault:
            faults.append(wrong.within("dependence"))
    return faults


def _refuse(result: Result, old: Inputs, new: Inputs) -> None:
    """Refuse changes that weights do not show."""
    if result.design.imported:
        raise InputError("what if: the rows are imported, and their density is unknown")
    for name in [name for name in old.laws if name not in new.laws]:
        if name not in new.tied:  # the file of another law of measured values is not read
            raise InputError(_measured(name))
    if new.tied != old.tied or list(new.laws) != list(old.laws):
        raise InputError(SAME)
    for name, law in old.laws.items():
        other = new.laws[name]
        if (law.times, law.level) != (other.times, other.level):
            raise InputError(f"what if: times and level of '{name}' cannot be changed")
        if law.discrete != other.discrete and isinstance(law, Empirical):
            raise InputError(_measured(name))
        if law.discrete != other.discrete:
            raise InputError(f"what if: '{name}' cannot change between listed and other values")
    if depends_otherwise(old, new):
        listed = [name for name in old.correlated if old.laws[name].discrete]
        if listed:
            raise InputError(
                f"what if: the listed values of '{listed[0]}' do not determine its dependence on"
                f" {', '.join(changed_laws(old, new)) or 'the others'}"
            )
    if not result.shown_outputs(result.analysis):
        raise InputError("what if: the result has no output")
