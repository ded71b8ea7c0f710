"""Choose the inputs to integrate exactly, which only scale lives, and add their laws to lives."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from uq.assess.row_inputs import Inputs, inputs_of
from uq.assess.scale_laws import (
    ConditionalScale,
    CopulaGiven,
    IndependentScale,
    NormalGiven,
    Scale,
    posterior_input,
    posterior_scale,
)
from uq.contract import Floats, Output
from uq.result.element import Element
from uq.result.result import Result
from uq.sampling.dependence import normal_correlations
from uq.sampling.law import Law
from uq.sampling.levels import LEVELS, SHARED
from uq.sampling.log_sums import LogTerm, law_of_sum
from uq.sampling.truncation import support
from uq.text.numbers import counted

NOT_POSITIVE = "it is not always positive"


def integrated(
    rows: Result, output: Output, inputs: Inputs, levels: Collection[str] | None = None
) -> tuple[Scale | None, dict[str, str]]:
    """Return the law of the inputs that only scale the lives of an output, given all others.

    Parameters
    ----------
    rows : Result
        The independent rows of a result, or samples of several rows.
    output : Output
    inputs : Inputs
        Of these rows.
    levels : collection of str, optional
        Only inputs of these levels.

    Returns
    -------
    law : Scale or None
        Of all inputs that are independent of the others, or of the one that depends on others if it
        alone scatters the lives more.
    kept : dict of str to str
        Input that scales the lives -> why it is not integrated.
    """
    exponents, kept, _ = _exponents(inputs, output.exponents)
    if levels is not None:
        level = {name: law.level for name, law in inputs.laws.items()}
        exponents = {name: e for name, e in exponents.items() if level[name] in levels}
        kept = {name: why for name, why in kept.items() if level[name] in levels}
    if rows.design.imported:
        return None, dict.fromkeys(exponents, "its rows are imported") | kept
    if rows.has_weights and not rows.has_next_rows:
        any_unit = rows.stands_for_any_unit
        learnt = {name for name in exponents if not any_unit or inputs.laws[name].level == SHARED}
        kept |= dict.fromkeys(learnt, "inspections have changed its law")
    for name in exponents:
        if problem := _problem(name, inputs) or _sign_problem(name, inputs):
            kept[name] = problem
    terms = {
        name: _term(inputs.laws[name], inputs.bounds[name], exponent)
        for name, exponent in exponents.items()
        if name not in kept and inputs.laws[name].times is None
    }
    free = {name: term for name, term in terms.items() if name not in inputs.correlated}
    bound = {
        name: _conditional(name, exponent, inputs)
        for name, exponent in exponents.items()
        if name not in kept and name not in free
    }
    reach = {name: law.given.deviation * law.spread for name, law in bound.items()}
    widest = max(bound, key=lambda name: reach[name], default="")
    if free and np.hypot.reduce([term.spread for term in free.values()]) >= reach.get(widest, 0.0):
        kept |= dict.fromkeys(bound, "it depends on other inputs, and others scatter lives more")
        return _independent(free, exponents, inputs, kept), kept
    kept |= dict.fromkeys({*free, *bound} - {widest}, f"{widest} scatters lives more")
    return bound.get(widest), kept


def scalers(inputs: Inputs, output: Output) -> dict[str, float]:
    """Return the exponents of the inputs that are integrated while their laws stay positive."""
    exponents, kept, _ = _exponents(inputs, output.exponents)
    return {
        name: exponent
        for name, exponent in exponents.items()
        if name not in kept and not _problem(name, inputs)
    }


def _exponents(
    inputs: Inputs, scales: Mapping[str, float]
) -> tuple[dict[str, float], dict[str, str], tuple[str, ...]]:
    """Return the exponents of the inputs in a life that scales.

    Returns
    -------
    scaling : dict of str to float
        Input -> exponent, with those of the parameters that equal it.
    kept : dict of str to str
        Inputs that do more than scale, or on which others depend -> reason.
    idle : tuple of str
        Inputs whose exponents cancel.
    """
    exponents: dict[str, float] = {}
    for name, exponent in scales.items():
        if name in inputs.laws or name in inputs.tied:
            leader = inputs.tied.get(name, name)
            exponents[leader] = exponents.get(leader, 0.0) + exponent
    kept = {}
    for leader in exponents:
        members = [leader, *(name for name, other in inputs.tied.items() if other == leader)]
        if other := next((name for name in members if name not in scales), ""):
            same = "it" if other == leader else f"{other} has the same value and"
            kept[leader] = f"{same} does more than scale lives"
        elif other := next((n for n, law in inputs.laws.items() if law.times == leader), ""):
            kept[leader] = f"{other} is a multiple of it"
    idle = tuple(name for name, exponent in exponents.items() if not exponent and name not in kept)
    return {name: exponent for name, exponent in exponents.items() if exponent}, kept, idle


def without_effect(inputs: Inputs, output: Output) -> tuple[str, ...]:
    """Return the inputs that scale the lives of an output to powers that cancel."""
    return _exponents(inputs, output.exponents)[2]


def _problem(name: str, inputs: Inputs) -> str:
    """Return why an input cannot be integrated, whatever its law may be, or ""."""
    law = inputs.laws[name]
    if law.discrete:
        return "its law is one of listed values"
    if not (inputs.values[name] > 0).all():
        return NOT_POSITIVE
    if law.times is not None:
        positive = (inputs.values[law.times] > 0).all()
        return "" if positive else "it is a multiple of an input that is not positive"
    if name in inputs.correlated:
        listed = [other for other in inputs.correlated if inputs.laws[other].discrete]
        return f"it depends on listed values of {listed[0]}" if listed else ""
    return ""


def _sign_problem(name: str, inputs: Inputs) -> str:
    law = inputs.laws[name]
    return "" if law.times or support(law, inputs.bounds[name])[0] > 0 else NOT_POSITIVE


@lru_cache(maxsize=64)
def _term(law: Law, bounds: tuple[float, float], exponent: float) -> LogTerm:
    return LogTerm(law, bounds, exponent)


@lru_cache(maxsize=64)
def _term_of_sum(terms: tuple[LogTerm, ...]) -> object:
    try:
        return law_of_sum(list(terms))
    except ArithmeticError:
        return None


def _independent(
    free: Mapping[str, LogTerm],
    exponents: Mapping[str, float],
    inputs: Inputs,
    kept: dict[str, str],
) -> IndependentScale:
    law = _term_of_sum(tuple(free.values()))
    if law is None:
        widest = max(free, key=lambda name: free[name].spread)
        kept |= dict.fromkeys({*free} - {widest}, "the law of their product is not smooth enough")
        free, law = {widest: free[widest]}, free[widest]
    drawn = sum(exponents[name] * np.log(inputs.values[name]) for name in free)
    return IndependentScale(tuple(free), law, drawn)  # type: ignore[arg-type]


def _conditional(name: str, exponent: float, inputs: Inputs) -> ConditionalScale:
    """Return the conditional law of an input given its correlated inputs."""
    law, bounds, values = inputs.laws[name], inputs.bounds[name], inputs.values[name]
    if law.times is not None:
        nothing = NormalGiven(np.zeros(len(values)), 1.0)
        other = inputs.values[law.times]
        return ConditionalScale((name,), law, bounds, exponent, values, nothing, other)
    return ConditionalScale((name,), law, bounds, exponent, values, _given_others(name, inputs))


def _given_others(name: str, inputs: Inputs) -> NormalGiven | CopulaGiven:
    """Return the conditional law of the probability of an input given its correlated inputs."""
    assert inputs.dependence is not None
    if (pair := inputs.dependence.pair) is not None:
        (partner,) = (other for other in inputs.correlated if other != name)
        return CopulaGiven(pair, inputs.probability(partner))
    slopes, deviation = given_others(name, inputs)
    mean = np.stack([inputs.normal(other) for other in slopes], axis=1) @ list(slopes.values())
    return NormalGiven(mean, deviation)


def given_others(name: str, inputs: Inputs) -> tuple[dict[str, float], float]:
    """Return slopes and deviation of the normal variable of an input, given the others.

    For the normal copula.
    """
    assert inputs.dependence is not None
    names = list(inputs.correlated)
    matrix = normal_correlations(inputs.dependence.rank_correlation)
    position, rest = names.index(name), [i for i, other in enumerate(names) if other != name]
    slope = np.linalg.solve(matrix[np.ix_(rest, rest)], matrix[rest, position])
    deviation = float(np.sqrt(1 - matrix[position, rest] @ slope))
    return dict(zip([names[i] for i in rest], slope.tolist(), strict=True)), deviation


def elements_with_laws(
    rows: Result, outputs: Sequence[str], *, plain: bool = False
) -> Iterator[Element]:
    """Yield the elements of outputs, with the laws of their lives where inputs are integrated.

    Parameters
    ----------
    rows : Result
        The independent rows of a result, or samples of several rows.
    outputs : sequence of str
    plain : bool
        Whether lives are taken as computed.

    Yields
    ------
    Element
    """
    inputs = None
    for element in rows.elements(outputs):
        if not plain and element.declared.exponents and not element.censored.any():
            inputs = inputs or inputs_of(rows)
            learnt = posterior_scale(rows, inputs, scalers(inputs, element.declared))
            law = learnt or integrated(rows, element.declared, inputs)[0]
            element = replace(element, law=law)
        yield element


def why_not_integrated(rows: Result, element: Element) -> str:
    """Return a sentence on inputs that scale lives but are not integrated, or ""."""
    inputs = inputs_of(rows)
    exponents, _, _ = _exponents(inputs, element.declared.exponents)
    if not exponents:
        return ""
    if element.censored.any():
        names = ", ".join(exponents)
        count = int(element.censored.sum())
        lives = counted(count, "life is", "lives are")
        return f"{names} not integrated: {lives} censored, which gives bounds only"
    _, kept = integrated(rows, element.declared, inputs)
    return not_integrated(
        {name: why for name, why in kept.items() if name != posterior_input(rows)}
    )


def not_integrated(kept: Mapping[str, str]) -> str:
    """Return a sentence on inputs that are not integrated, or ""."""
    return "; ".join(f"{name} not integrated: {why}" for name, why in kept.items())


@dataclass(frozen=True)
class Scales:
    """Laws of the inputs integrated in the logarithms of lives, by level.

    Attributes
    ----------
    laws : dict of str to Scale
        By level.
    why_not_more : str
        A sentence on the inputs that scale lives but are not integrated, or "".
    idle : tuple of str
        Inputs that scale lives to powers that cancel.
    """

    laws: Mapping[str, Scale]
    why_not_more: str = ""
    idle: tuple[str, ...] = ()

    @property
    def inputs(self) -> tuple[str, ...]:
        """Integrated inputs."""
        return tuple(name for law in self.laws.values() for name in law.inputs)

    def mean_logarithms(self, logarithms: Floats) -> Floats:
        """Return the means of the logarithms of lives over the integrated inputs, shape (n,)."""
        return sum((law.moments[0] for law in self.laws.values()), start=logarithms)

    @property
    def variances(self) -> dict[str, Floats]:
        """Level -> the variance of the logarithm that is integrated there, of each row."""
        return {level: law.moments[1] for level, law in self.laws.items()}


def scales_by_level(rows: Result, element: Element) -> Scales:
    """Return the laws of the inputs that only scale the lives of an element, by level.

    Parameters
    ----------
    rows : Result
        The independent rows of a result, or samples of several rows.
    element : Element
        A life of these rows, none censored.
    """
    if not element.declared.exponents:
        return Scales({})
    inputs = inputs_of(rows)
    parts = {level: integrated(rows, element.declared, inputs, {level}) for level in LEVELS}
    kept = {name: why for _, reasons in parts.values() for name, why in reasons.items()}
    laws = {level: law for level, (law, _) in parts.items() if law is not None}
    return Scales(laws, not_integrated(kept), without_effect(inputs, element.declared))
