"""The chapters of a dossier, in the order of the outline, and as HTML."""

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

from uq.assess.findings import Findings
from uq.render.html.dossier import assessment, results
from uq.render.html.dossier.items import Item
from uq.render.html.dossier.outline import DOCUMENTS, OUTLINE, Heading
from uq.render.html.layout import laid_out
from uq.result.result import Result

Source = Callable[[Findings, str], Iterator[Item]]

CONTENTS: Mapping[str, Source] = {
    "context": assessment.context,
    "information": assessment.information,
    "quantities": assessment.quantities,
    "software": assessment.software,
    "models": assessment.models,
    "inputs": assessment.inputs,
    "propagation": results.propagation,
    "convergence": results.convergence,
    "sensitivities": results.sensitivities,
    "uncertainty": results.uncertainty,
    "studies": results.studies,
    "conclusions": results.conclusions,
}
"""Name of a heading -> what a result provides under it."""


class Chapter(NamedTuple):
    """A heading and what is expected under it, provided or not."""

    heading: Heading
    items: list[Item]


def chapters(result: Result, file: str) -> list[Chapter]:
    """Return what a result provides, in the order of the outline.

    Parameters
    ----------
    result : Result
        A result.
    file : str
        The name of its file.

    Returns
    -------
    list of Chapter
    """
    findings = Findings(result)
    return [Chapter(title, list(CONTENTS[title.name](findings, file))) for title in OUTLINE]


def dossier(result: Result, name: str) -> str:
    """Return the dossier of a result as HTML; as `uq.render.html.page.page` returns its report."""
    return laid_out(
        "dossier/dossier.html", result, chapters=chapters(result, name), documents=DOCUMENTS
    )
