"""Laws fitted to a lifetime as a table."""

from typing import Any

import pandas as pd

from uq.assess.life_fit import Fit, fits_of
from uq.assess.statistics.quantiles import B_LIVES
from uq.result.result import AnyResult, Result

_PARAMETERS = ("shape", "scale", "median", "sigma")
_FACTS = ("rows", "p_value", "refused", "assumes")
_ENDS = ("", "_low", "_high")
_COLUMNS = [
    *_FACTS,
    *(f"{name}{end}" for name in (*_PARAMETERS, *B_LIVES) for end in _ENDS),
    *(f"{name}_extrapolated" for name in B_LIVES),
]


def life_fits(result: AnyResult, output: str) -> pd.DataFrame:
    """Fit Weibull and lognormal laws to a lifetime.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result of design ``monte-carlo``.
    output : str
        A lifetime, or one element of it.

    Returns
    -------
    pandas.DataFrame
        Index: ``output`` (its element) and ``law`` (``weibull``, ``lognormal``). Columns: ``rows``
        used; ``p_value`` of the Anderson-Darling test, its distribution from refits; ``refused``,
        why the law does not apply, or ""; ``assumes``, what its numbers rest on. Where it is not
        refused: its parameters, named as in study files (``shape`` and ``scale`` [s]; ``median``
        [s] and ``sigma``), and ``B1``, ``B10``, ``B50`` [s], each with ``_low`` and ``_high`` for
        the 95 % interval; ``B1_extrapolated`` and so on: whether that life is earlier than the rows
        reach, 1/(n + 1). NaN where there is no number.

    Raises
    ------
    InputError
        When there is no such output or it is not a lifetime.

    Notes
    -----
    Intervals are exact for complete samples, whose pivots do not depend on the parameters [1]_,
    and those of the parametric bootstrap for censored ones, with censoring times drawn from their
    own Kaplan-Meier estimate, which assumes that censoring is non-informative.

    References
    ----------
    .. [1] J. F. Lawless, "Statistical models and methods for lifetime data", 2nd ed., Wiley
       (2003), sections 5.1.2 and 10.3.

    Examples
    --------
    >>> laws = uq.life_fits(uq.run("studies/exponential-wear.toml"), "life").loc["life"]
    >>> laws.loc["lognormal", "sigma"].round(1).item()
    0.5
    >>> laws.loc["weibull", "refused"].startswith("rejected")
    True
    """
    result = Result.of(result)
    result.refuse_weights("laws fitted to lives")
    rows = result.independent
    independent = rows.replicates is None
    lines = {
        (element.name, law): _line(fit)
        for element in rows.lifetimes(output)
        for law, fit in fits_of(element, independent).items()
    }
    index = pd.MultiIndex.from_tuples(list(lines), names=["output", "law"])
    return pd.DataFrame(list(lines.values()), index=index, columns=_COLUMNS)


def _line(fit: Fit) -> dict[str, Any]:
    numbers = {
        f"{name}{end}": number
        for name, estimate in {**fit.parameters, **fit.b_lives}.items()
        for end, number in zip(_ENDS, estimate.numbers, strict=True)
    }
    extrapolated = {f"{name}_extrapolated": name in fit.extrapolated for name in fit.b_lives}
    return {name: getattr(fit, name) for name in _FACTS} | numbers | extrapolated
