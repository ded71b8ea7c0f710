"""Variance components by level, and the level with most of the variance."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isnan

from uq.assess.answer.rankings import Ranking
from uq.assess.answer.wording import called, joined, rounded, sentence, share_text
from uq.assess.components_by_level import switching
from uq.assess.fact import Fact
from uq.assess.findings import Findings
from uq.assess.regimes import compared_rows, still_uncertain
from uq.assess.targets import FORMS, split_name
from uq.result.result import Result
from uq.sampling.levels import CHANCE, LEVELS, OWN, SHARED
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.stats.uncertainty_exponent import uncertainty_exponent
from uq.stats.variance_components import nested_shares

_MOST_NAMED = 4

_MACHINE, _CHANCE = "the machine", "chance"


@dataclass(frozen=True)
class VarianceComponent:
    """Share of the variance due to one level.

    Attributes
    ----------
    name : {"shared", "own", "chance"}
    words : str
        ``initial conditions``, ``the machine``.
    inputs : tuple of str
        Inputs of this level, the largest contributions first.
    ranked : int
        Number of contributing inputs.
    share : Estimate
    """

    name: str
    words: str
    inputs: tuple[str, ...]
    share: Estimate
    ranked: int = 0

    @property
    def explains(self) -> str:
        """The verb for its words."""
        return "explains" if self.words in (_MACHINE, _CHANCE) else "explain"

    @property
    def inputs_named(self) -> str:
        """Its contributing inputs by their names, or the first inputs."""
        named = [
            called(name) for name in self.inputs[: min(self.ranked or _MOST_NAMED, _MOST_NAMED)]
        ]
        more = len(self.inputs) - len(named)
        return joined([*named, f"{more} more"] if more else named)


@dataclass(frozen=True)
class VarianceComponents:
    """Variance components of a target.

    Attributes
    ----------
    target : str
        Name of the target, as in `uq.levels`.
    variance : str
        The apportioned variance: ``the variance of the logarithm``, ``the variance in whether it
        is periodic``.
    levels : tuple of VarianceComponent
        Levels on which something varies, the largest share first.
    another : Estimate or None
        Probability that a repeat ends in another regime, of a target that is one.
    """

    target: str
    variance: str
    levels: tuple[VarianceComponent, ...]
    another: Estimate | None = None

    @property
    def fact(self) -> Fact:
        """The shares with their sentence."""
        shares = {
            component.name: estimate_json.numbers(component.share) for component in self.levels
        }
        another = None
        if self.another is not None:
            numbers = estimate_json.numbers(self.another)
            another = Fact(numbers, words=self.switching, mentions=(("value",),))
        return Fact(
            {
                "sentence": self.sentence,
                "target": self.target,
                "shares": Fact(shares),
                "another_regime": another,
            },
            (nested_shares,),
            {"another_regime": (switching,)},
            mentions=tuple(("shares", name, "value") for name in shares),
            more={"inputs": {level.name: list(level.inputs) for level in self.levels}},
        )

    @property
    def leader(self) -> VarianceComponent | None:
        """The level with most of the variance, if settled."""
        first = self.levels[0]
        return first if first.share.has_interval and first.share.low > 0.5 else None

    @property
    def sentence(self) -> str:
        """The main level with its share."""
        first, rest = self.levels[0], self.levels[1:]
        if self.leader is None:
            shares = [
                f"{component.words} {share_text(component.share)}" for component in self.levels
            ]
            return f"No level clearly explains most of {self.variance}: {', '.join(shares)}."
        named = f" ({first.inputs_named})" if first.inputs else ""
        share = f"{share_text(first.share)} of {self.variance}"
        others = [f"{component.words} {share_text(component.share)}" for component in rest]
        text = f"{first.words}{named} {first.explains} {share}"
        return sentence(", ".join([text, *others]))

    @property
    def switching(self) -> str:
        """Share of repeats that end in another regime; "" if unknown."""
        if self.another is None or isnan(self.another.value):
            return ""
        return f"{share_text(self.another)} of repeats end in another regime."


def levels_of(
    findings: Findings, target: str, question: str = "", ranking: Ranking | None = None
) -> VarianceComponents | None:
    """Return the variance components of a target; None if unknown.

    Parameters
    ----------
    findings : Findings
    target : str
        Of an element, such as ``life``, or of an event.
    question : str
        Of an event, in words: ``whether it is periodic``.
    ranking : Ranking, optional
        Of the inputs: a level names first those that contribute most.
    """
    if not findings.result.is_nested or findings.result.has_weights:
        return None
    decomposition = findings.levels
    name = next(
        (label for label in decomposition.outputs if target in (label, split_name(label)[1])), None
    )
    if name is None:
        return None
    words = _words(findings, decomposition.inputs, decomposition.units)
    shares = decomposition.outputs[name].shares
    ranked = (
        ()
        if ranking is None
        else [n for contribution in ranking.contributions for n in contribution.sure]
    )
    place = {name: i for i, name in enumerate(ranked)}

    def on(level: str) -> tuple[str, ...]:
        return tuple(
            sorted(decomposition.inputs_on(level), key=lambda name: place.get(name, len(place)))
        )

    components = [
        VarianceComponent(
            level, words[level], on(level), shares[level], len(place.keys() & set(on(level)))
        )
        for level in LEVELS
        if decomposition.inputs_on(level) or shares[level].value > 0
    ]
    if len(components) < 2 or any(isnan(component.share.value) for component in components):
        return None
    form = FORMS.get(split_name(name)[0])
    variance = f"the variance in {question}" if question else "the variance"
    return VarianceComponents(
        name,
        f"the variance of the {form}" if form else variance,
        tuple(sorted(components, key=lambda component: -component.share.value)),
        decomposition.another_regime if target.startswith("P(regime=") else None,
    )


def _words(findings: Findings, inputs: Mapping[str, str], units: int) -> dict[str, str]:
    """Return the names of the levels, by their inputs."""
    drawn_anew = [name for name, level in inputs.items() if level == CHANCE]
    starts = any("initial" in findings.result.dataset[name].attrs for name in drawn_anew)
    return {
        SHARED: "shared inputs",
        OWN: _MACHINE if units == 1 else "differences between units",
        CHANCE: "initial conditions" if starts else _CHANCE,
    }


def starts_alike(result: Result) -> str:
    """Return a sentence on initial conditions that are equal in all rows, or ""."""
    starts = [
        name
        for name, variable in result.dataset.variables.items()
        if variable.attrs.get("role") in ("input", "fixed") and "initial" in variable.attrs
    ]
    if not starts or any(result.dataset[name].attrs.get("role") == "input" for name in starts):
        return ""
    named = joined([called(str(name)) for name in starts])
    verb = "is" if len(starts) == 1 else "are"
    return f"The effect of initial conditions on the regime is unknown: {named} {verb} fixed."


def intermingled(exponent: Estimate, rows: Result | None = None) -> Fact:
    """Return the uncertainty exponent of regimes; without members if boundaries may be smooth.

    Parameters
    ----------
    exponent : Estimate
        The uncertainty exponent of the boundary between them.
    rows : Result, optional
        The rows that it is computed from.

    Returns
    -------
    Fact
        ``uncertainty_exponent``, and ``left``: the share of uncertain outcomes that remain
        uncertain with half the uncertainty of all inputs; both with ends.
    """
    if not (exponent.has_interval and exponent.high < 1):
        return Fact({})
    left = still_uncertain(exponent)
    text = (
        "The regimes are intermingled: with half the uncertainty of all inputs,"
        f" {share_text(left)} of the uncertain outcomes would remain uncertain, against 50 % at"
        f" smooth boundaries (uncertainty exponent {rounded(exponent.value)})."
    )
    numbers = {
        f"{name}{end}": value
        for name, estimate in (("uncertainty_exponent", exponent), ("left", left))
        for end, value in zip(("", "_low", "_high"), estimate.numbers, strict=True)
    }
    mentions = (("left",),)
    return Fact({"sentence": text} | numbers, (uncertainty_exponent,), rows=rows, mentions=mentions)


def mixing(findings: Findings) -> Fact:
    """Return the uncertainty exponent of the regimes of a result."""
    boundary = findings.boundary
    if boundary is None:
        return Fact({})
    return intermingled(boundary.estimate, compared_rows(findings.result))
