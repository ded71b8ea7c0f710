"""Exactly known variance of lives from inputs that only scale them, level by level.

The logarithm of a life is that of everything else, plus a sum of independent terms of each level.
With the terms at their means, the variances of the terms are added to those of the levels.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from uq.assess.row_inputs import inputs_of
from uq.assess.scale_laws import Scale
from uq.assess.scaling import integrated, not_integrated, without_effect
from uq.contract import Floats
from uq.result.element import Element
from uq.result.result import Result
from uq.sampling.levels import LEVELS


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
    if not element.declared.scales:
        return Scales({})
    inputs = inputs_of(rows)
    parts = {level: integrated(rows, element.declared, inputs, {level}) for level in LEVELS}
    kept = {name: why for _, reasons in parts.values() for name, why in reasons.items()}
    laws = {level: law for level, (law, _) in parts.items() if law is not None}
    return Scales(laws, not_integrated(kept), without_effect(inputs, element.declared))
