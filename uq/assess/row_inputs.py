"""The uncertain inputs of some rows: their values, and the laws that these follow."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.result.result import Result
from uq.sampling.law import Law
from uq.sampling.truncation import cdf_within, factor_of
from uq.study.file import DependenceTable, StudyFile, Tied
from uq.study.input_checks import laws_of

EVERYWHERE = (-inf, inf)


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

    def normal(self, name: str) -> Floats:
        """Return the standard normal variables behind the values of a parameter."""
        share = cdf_within(self.laws[name], self.values[name], self.bounds[name])
        return np.asarray(special.ndtri(np.clip(share, 2.0**-54, 1 - 2.0**-53)))


def inputs_of(rows: Result, study: StudyFile | None = None, text: str = "") -> Inputs:
    """Return the uncertain inputs of rows.

    Parameters
    ----------
    rows : Result
    study : StudyFile, optional
        Another study of the same inputs, with its `text`.
    """
    study, text = (rows.study, rows.dataset.attrs["study"]) if study is None else (study, text)
    laws = laws_of(text)
    tied = {name: law.equals for name, law in study.uncertain.items() if isinstance(law, Tied)}
    admissible = {
        name: tuple(map(float, rows.dataset[name].attrs.get("admissible", EVERYWHERE)))
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
