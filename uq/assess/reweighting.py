"""Weights that turn the rows of a result into those of another study; laws of lives replaced."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
from scipy import special

from uq.assess.integrated_inputs import integrated
from uq.assess.row_inputs import EVERYWHERE, Inputs
from uq.contract import Floats
from uq.errors import InputError, RunError
from uq.result.element import Element
from uq.result.result import Result
from uq.sampling.dependence import normal_correlations
from uq.sampling.truncation import OUTSIDE_AT_MOST, factor_ends, log_density_between, ppf_within
from uq.stats.dependent_rows import Dependence
from uq.stats.importance_weights import ImportanceWeights, impossible_weights, smoothed
from uq.text.numbers import percent


def log_ratio(rows: int, old: Inputs, new: Inputs, integrated: Collection[str] = ()) -> Floats:
    """Return the logarithm of the new density of the inputs over the old one, shape (n,).

    Parameters
    ----------
    rows : int
        How many.
    old, new : Inputs
        Of these rows.
    integrated : collection of str
        Inputs that do not take part.
    """
    ratio = np.zeros(rows)
    for name in changed_laws(old, new):
        if name not in integrated:
            ratio += _log_density(new, name) - _log_density(old, name)
    if depends_otherwise(old, new):
        ratio += _log_copula(new, integrated) - _log_copula(old, integrated)
    return ratio


def changed_laws(old: Inputs, new: Inputs) -> list[str]:
    """Return the parameters whose law is another one."""
    return [name for name in old.laws if not _same(old.laws[name], new.laws[name])]


def depends_otherwise(old: Inputs, new: Inputs) -> bool:
    """Return whether correlated inputs have other laws or other correlations."""
    if old.dependence is None or new.dependence is None:
        return False
    if old.dependence.joint != new.dependence.joint:
        return True
    return any(name in old.correlated for name in changed_laws(old, new))


def share_without_rows(old: Inputs, new: Inputs, name: str) -> float:
    """Return the probability of the new law of a parameter where the old one has none."""
    z = np.linspace(-6.0, 6.0, 1201)
    ends = EVERYWHERE if new.laws[name].times else new.bounds[name]
    places = ppf_within(new.laws[name], special.ndtr(z), ends)
    lost = np.isneginf(log_density_between(old.laws[name], places, *ends))
    share = float(np.average(lost, weights=np.exp(-(z**2) / 2)))
    return share if share > OUTSIDE_AT_MOST else 0.0


def _same(law: object, other: object) -> bool:
    ignored = {"source", "file", "column"}
    return law.model_dump(exclude=ignored) == other.model_dump(exclude=ignored)  # type: ignore[attr-defined]


def _log_density(inputs: Inputs, name: str) -> Floats:
    law = inputs.laws[name]
    ends = inputs.bounds[name]
    if law.times is not None:
        ends = factor_ends(inputs.values[law.times], ends)
    return log_density_between(law, inputs.law_values(name), *ends)


def _log_copula(inputs: Inputs, integrated: Collection[str]) -> Floats:
    """Return the logarithm of the density of the copula of the inputs that are not integrated."""
    assert inputs.dependence is not None
    if (pair := inputs.dependence.pair) is not None:
        if any(name in integrated for name in inputs.correlated):
            return np.zeros(1)  # the law of a single input is uniform under any copula
        return pair.log_density(*map(inputs.probability, inputs.correlated))
    names, matrix = correlations(inputs, integrated)
    z = np.stack([inputs.normal(name) for name in names], axis=1)
    excess = np.linalg.inv(matrix) - np.eye(len(names))
    _, log_determinant = np.linalg.slogdet(matrix)
    return np.asarray(-0.5 * (np.einsum("ni,ij,nj->n", z, excess, z) + log_determinant))


def correlations(inputs: Inputs, integrated: Collection[str] = ()) -> tuple[list[str], Floats]:
    """Return the correlated inputs that are not integrated, and how their normal variables are.

    For the normal copula.

    Returns
    -------
    names : list of str
    matrix : ndarray, shape (k, k)
    """
    assert inputs.dependence is not None
    names = [name for name in inputs.correlated if name not in integrated]
    kept = [inputs.correlated.index(name) for name in names]
    return names, normal_correlations(inputs.dependence.rank_correlation)[np.ix_(kept, kept)]


class Weighting:
    """Importance weights of the rows of a result under the laws of another study.

    Parameters
    ----------
    rows : Result
        The independent rows of a result, or samples of several rows.
    old, new : Inputs
        The inputs of these rows, with the laws of either study.
    dependence : Dependence
        Of the rows.

    Attributes
    ----------
    used : dict of str to ImportanceWeights
        Element -> its weights.
    refused : dict of str to ImportanceWeights
        Element -> its weights, which cannot be trusted, or are impossible: the other study has
        values where no row can be.
    """

    def __init__(self, rows: Result, old: Inputs, new: Inputs, dependence: Dependence):
        self._rows, self._old, self._new, self._dependence = rows, old, new, dependence
        self.used: dict[str, ImportanceWeights] = {}
        self.refused: dict[str, ImportanceWeights] = {}
        self.integrating = cache(self._integrating)

    @property
    def all_inputs(self) -> ImportanceWeights:
        """The weights with nothing integrated."""
        return self.integrating(())

    @property
    def quality(self) -> tuple[float, float]:
        """The least effective number of rows of the weights used, and their largest Pareto k."""
        used = self.used.values()
        return (
            min((weights.effective for weights in used), default=0.0),
            max((weights.k for weights in used), default=0.0),
        )

    def refuse_if_unused(self) -> None:
        """Raise the first refusal where no element has reliable weights.

        Raises
        ------
        InputError
            When the weights are impossible.
        RunError
            When they cannot be trusted.
        """
        if self.refused and not self.used:
            first = next(iter(self.refused.values()))
            raise (InputError if first.impossible else RunError)(first.refusal)

    def elements(self, outputs: Sequence[str]) -> Iterator[Element]:
        """Yield the elements of the outputs whose weights are reliable."""
        for element in self._rows.elements(outputs):
            law = None
            if element.declared.exponents and not element.censored.any():
                law = integrated(self._rows, element.declared, self._new)[0]
            weights = self.integrating(law.inputs if law else ())
            if weights.refusal:
                self.refused[element.name] = weights
                continue
            self.used[element.name] = weights
            yield replace(element, law=law, weights=weights.weights)

    def _integrating(self, inputs: tuple[str, ...]) -> ImportanceWeights:
        """Return the weights of rows in which these inputs are integrated."""
        for name in changed_laws(self._old, self._new):
            if name not in inputs and (share := share_without_rows(self._old, self._new, name)):
                return impossible_weights(
                    len(self._rows),
                    f"uncertain.{name}: {percent(share)} of its probability is where there are no"
                    " rows; run it as a separate study",
                )
        weights = log_ratio(len(self._rows), self._old, self._new, inputs)
        if not np.isfinite(weights.max()):
            why = "no row of this result is possible under the other laws"
            return impossible_weights(len(weights), why)
        return smoothed(weights, self._dependence)
