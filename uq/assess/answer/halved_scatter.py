"""Laws with half their scatter: the entries of the study file that give them, and in words."""

from collections.abc import Sequence
from math import sqrt

from uq.assess.answer.wording import DisplayUnit, called, unit_of_input
from uq.result.result import Result
from uq.sampling.law import Law
from uq.sampling.scipy_laws import LogUniform
from uq.study.file import Tied
from uq.text.numbers import percent

_WIDTHS = ("sd", "cv", "sigma")


def halved(law: Law) -> dict[str, float]:
    """Return the arguments that halve the scatter of a law about its middle; none if unknown.

    Parameters
    ----------
    law : Law
    """
    for name in _WIDTHS:
        if (width := getattr(law, name, None)) is not None:
            return {name: width / 2}
    lower, upper = getattr(law, "lower", None), getattr(law, "upper", None)
    if lower is None or upper is None:
        return {}
    if isinstance(law, LogUniform):
        centre, ratio = sqrt(lower * upper), (upper / lower) ** 0.25
        return {"lower": centre / ratio, "upper": centre * ratio}
    mode: float | None = getattr(law, "mode", None)
    middle = (lower + upper) / 2 if mode is None else mode
    return {"lower": (lower + middle) / 2, "upper": (upper + middle) / 2}


def halvings(result: Result, inputs: Sequence[str]) -> dict[str, dict[str, float]]:
    """Return the arguments that halve the scatter of each input; none if an input has no middle.

    Parameters
    ----------
    result : Result
        A result.
    inputs : sequence of str
    """
    laws = result.study.uncertain
    arguments = {}
    for name in inputs:
        law = laws[name]
        arguments[name] = {} if isinstance(law, Tied) else halved(law)
    return arguments if all(arguments.values()) else {}


def halvings_in_words(result: Result, changes: dict[str, dict[str, float]]) -> str:
    """Return the halved scatter in words: ``sd 0.5 mm instead of 1``; once for equal laws."""
    texts = {name: _in_words(result, name, arguments) for name, arguments in changes.items()}
    if len(set(texts.values())) == 1:
        return next(iter(texts.values()))
    return "; ".join(f"{called(name)}: {text}" for name, text in texts.items())


def _in_words(result: Result, name: str, new: dict[str, float]) -> str:
    law = result.study.uncertain[name]
    old = {key: float(getattr(law, key)) for key in new}
    if "lower" in new:
        is_factor = getattr(law, "times", None) is not None
        unit = DisplayUnit() if is_factor else unit_of_input(result, name)
        then = unit.between(new["lower"], new["upper"])
        return f"{then} instead of {unit.bare_between(old['lower'], old['upper'])}"
    ((key, before),) = old.items()
    if key == "sd":
        unit = unit_of_input(result, name)
        return f"sd {unit.text(new[key])} instead of {unit.number(before)}"
    shown = percent if key == "cv" else "{:.3g}".format
    return f"{key} {shown(new[key])} instead of {shown(before)}"
