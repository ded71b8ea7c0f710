"""The chapters of a dossier, in the order of the outline, and as HTML."""

from uq.assess.findings import Findings
from uq.render.html.dossier.assessment import (
    context,
    information,
    inputs,
    models,
    quantities,
    software,
)
from uq.render.html.dossier.items import Item
from uq.render.html.dossier.outline import DOCUMENTS, Heading
from uq.render.html.dossier.results import (
    conclusions,
    convergence,
    propagation,
    sensitivities,
    studies,
    uncertainty,
)
from uq.render.html.layout import laid_out
from uq.result.result import Result

_TOPICS = "RG 1.245, section C.2"

OUTLINE = (
    Heading(context, "Context", (_TOPICS,)),
    Heading(information, "Information made available", (_TOPICS,)),
    Heading(
        quantities,
        "Quantities of interest and acceptance criteria",
        (_TOPICS, "JCGM 101, 5.1"),
    ),
    Heading(
        software,
        "Software quality assurance, verification and validation",
        (_TOPICS,),
    ),
    Heading(models, "Models", (_TOPICS, "JCGM 101, 5.1")),
    Heading(inputs, "Inputs and their uncertainty", (_TOPICS, "JCGM 101, 6")),
    Heading(propagation, "Propagation of uncertainty", (_TOPICS, "JCGM 101, 7.2 to 7.4")),
    Heading(convergence, "Convergence", (_TOPICS, "JCGM 101, 7.9")),
    Heading(sensitivities, "Sensitivity analyses", (_TOPICS,)),
    Heading(
        uncertainty,
        "Uncertainty of the quantities of interest",
        (_TOPICS, "JCGM 101, 5.5"),
    ),
    Heading(studies, "Sensitivity studies", (_TOPICS,)),
    Heading(conclusions, "Conclusions", ("NUREG/CR-7278",)),
)
"""In the order of RG 1.245; the wording is ours."""


def chapters(result: Result, file: str) -> dict[Heading, list[Item]]:
    """Return what is expected under each heading, provided or not, in the order of the outline.

    Parameters
    ----------
    result : Result
        A result.
    file : str
        The name of its file.
    """
    findings = Findings(result)
    return {heading: list(heading.source(findings, file)) for heading in OUTLINE}


def dossier(result: Result, name: str) -> str:
    """Return the dossier of a result as HTML; as `uq.render.html.page.page` returns its report."""
    return laid_out(
        "dossier/dossier.html", result, chapters=chapters(result, name), documents=DOCUMENTS
    )
