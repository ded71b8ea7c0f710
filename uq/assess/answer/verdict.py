"""Verdict on the number of rows, in sentences."""

from math import isfinite

from uq.assess.answer.answer import without_advice
from uq.assess.answer.quantities import quantities
from uq.assess.answer.sufficiency import enough_of, settled
from uq.assess.answer.wording import sentence
from uq.assess.findings import Findings


def verdict(findings: Findings, output: str | None = None) -> list[str]:
    """Return the verdict on the sample size in sentences, the least settled first.

    Parameters
    ----------
    findings : Findings
    output : str, optional
        Only for this output, or this element of one.
    """
    result = findings.result
    if output is None:
        answer = without_advice(findings)
        asked, enough = answer.quantities, answer.enough
    else:
        asked = tuple(
            quantity
            for quantity in quantities(findings)
            if output in (quantity.name, quantity.output)
        )
        enough = enough_of(findings, asked)
    if not len(result):
        return []
    if enough.unknown:
        return [f"Whether the rows are enough is not known: {enough.unknown}."]
    if not enough.every:
        return ["Enough rows: what the study asks is settled."] if asked else []
    lines = [
        f"Not enough rows: {settled(clause, factor, result)}"
        if isfinite(factor)
        else f"{sentence(clause)} More rows would not help."
        for clause, factor in enough.every
    ]
    return lines if enough.question else ["Enough rows for what the study is about.", *lines]
