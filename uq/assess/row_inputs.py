"""Values of the inputs in each row, with their laws and dependence."""

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.result.result import Result
from uq.sampling.designs import DESIGNS
from uq.sampling.law import Law
from uq.sampling.truncation import cdf_within, factor_of
from uq.study.file import DependenceTable, StudyFile, Tied
from uq.study.input_checks import laws_of

EVERYWHERE = (-inf, inf)
"""Bounds that cut nothing off. Those of a parameter cut off at most a millionth of its law."""


@dataclass(frozen=True)
class Inputs:
    """Values and laws of the uncertain inputs of rows.

    Attributes
    ----------
    laws : dict of str to Law
        Laws; for a multiple of another parameter, the law of the factor.
    tied : dict of str to str
        Parameter -> the parameter that it equals.
    dependence : DependenceTable or None
    bounds : dict of str to tuple of float
        Bounds, shared by tied parameters.
    values : dict of str to ndarray, shape (n,)
        Values of the rows.
    """

    laws: Mapping[str, Law]
    tied: Mapping[str, str]
    dependence: DependenceTable | None
    bounds: Mapping[str, tuple[float, float]]
    values: Mapping[str, Floats]

    @property
    def correlated(self) -> Sequence[str]:
        """Parameters with rank correlations."""
        return () if self.dependence is None else self.dependence.parameters

    def law_values(self, name: str) -> Floats:
        """Return the values that follow the law of a parameter: its values or its factors."""
        law, values = self.laws[name], self.values[name]
        return values if law.times is None else factor_of(law, values, self.values[law.times])

    def probability(self, name: str) -> Floats:
        """Return the probabilities, within (0, 1), behind the values of a parameter."""
        share = cdf_within(self.laws[name], self.values[name], self.bounds[name])
        return np.clip(share, 2.0**-54, 1 - 2.0**-53)

    def normal(self, name: str) -> Floats:
        """Return the standard normal variables behind the values of a parameter."""
        return np.asarray(special.ndtri(self.probability(name)))


def normal_scores(values: Floats, law: Law, bounds: tuple[float, float]) -> Floats:
    """Return the standard normal variables behind values of a law within bounds."""
    share = cdf_within(law, values, bounds)
    return np.asarray(special.ndtri(np.clip(share, 2.0**-54, 1 - 2.0**-53)))


def inputs_of(
    rows: Result, study: StudyFile | None = None, laws: dict[str, Law] | None = None
) -> Inputs:
    """Return the uncertain inputs of rows.

    Parameters
    ----------
    rows : Result
    study : StudyFile, optional
        Another study of the same inputs.
    laws : dict of str to Law, optional
        Those of the other study.
    """
    study = rows.study if study is None else study
    laws = laws_of(rows.dataset.attrs["study"]) if laws is None else laws
    tied = {name: law.equals for name, law in study.uncertain.items() if isinstance(law, Tied)}
    admissible = {
        name: tuple(map(float, rows.dataset.variables[name].attrs.get("admissible", EVERYWHERE)))
        for name in study.uncertain
    }
    bounds = {}
    for name in laws:
        ends = [
            admissible[parameter]
            for parameter in (name, *(a for a, b in tied.items() if b == name))
        ]
        bounds[name] = (max(low for low, _ in ends), min(high for _, high in ends))
    return Inputs(laws, tied, study.dependence, bounds, _Columns(rows))


class _Columns(dict[str, Floats]):
    """Columns of a result, each read when it is first needed."""

    def __init__(self, rows: Result):
        self._dataset = rows.dataset

    def __missing__(self, name: str) -> Floats:
        self[name] = self._dataset[name].values
        return self[name]


def independent_inputs(result: Result) -> dict[str, Floats]:
    """Return the values of each input as its own law gives them.

    Parameters
    ----------
    result : Result
        A result.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        Without parameters that equal another; for one that is another times a factor, the factor.
        With inputs that have rank correlations.
    """
    return {
        name: result.dataset[name].values
        if law.times is None
        else factor_of(law, result.dataset[name].values, result.dataset[law.times].values)
        for name, law in laws_of(result.dataset.attrs["study"]).items()
    }


def scores_of_inputs(result: Result) -> dict[str, Callable[[Floats], Floats]]:
    """Return functions of the values of `independent_inputs` that give their normal scores.

    Returns
    -------
    dict of str to callable
        Of inputs with a continuous law; empty if rows are imported.
    """
    if result.design.imported:
        return {}
    inputs = inputs_of(result)
    return {
        name: partial(
            normal_scores, law=law, bounds=inputs.bounds[name] if law.times is None else EVERYWHERE
        )
        for name, law in inputs.laws.items()
        if not law.discrete
    }


def correlated_inputs(result: Result) -> dict[str, tuple[str, ...]]:
    """Return the inputs with stated rank correlations: name -> correlated inputs."""
    stated = result.study.dependence
    if stated is None:
        return {}
    names, dependent = stated.parameters, stated.pair is not None  # even without rank correlation
    return {
        name: tuple(
            other
            for other, rank in zip(names, row, strict=True)
            if (rank or dependent) and other != name
        )
        for name, row in zip(names, stated.rank_correlation, strict=True)
    }


def why_dependent(result: Result) -> str:
    """Return a clause on why inputs are not assumed to be independent, or ""."""
    study = result.study
    if study.dependence is not None:
        return "the inputs of this study depend on each other"
    if DESIGNS[study.design.method].imported and not study.design.independent:
        return "imported inputs may depend on each other"
    return ""


_DUE = "the index of an input may be due to another"
_DIVIDED = "what correlated inputs explain in common is divided among them"


def notes_on_inputs(result: Result) -> list[str]:
    """Return sentences on the meaning of indices of tied or dependent inputs."""
    notes, tied = [], defaultdict[str, list[str]](list)
    for name, entry in result.study.uncertain.items():
        if isinstance(entry, Tied):
            tied[entry.equals].append(name)
        elif entry.times is not None:
            notes.append(f"{name} is {entry.times} times a factor: its index refers to the factor")
    for name, others in tied.items():
        equal, together = ("equals", "both") if len(others) == 1 else ("equal", "all of them")
        notes.append(
            f"{' and '.join(others)} {equal} {name}: the index of {name} is that of {together}"
        )
    if why := why_dependent(result):
        shared = result.design.layout.given_the_rest
        notes.append(f"{why}: {_DIVIDED if shared else _DUE}")
    return notes
