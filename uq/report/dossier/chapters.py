"""The chapters of a dossier, in the order of the outline, and as HTML."""

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

import xarray as xr

from uq.analysis.findings import Findings
from uq.report.dossier import assessed, found
from uq.report.dossier.items import Item
from uq.report.dossier.outline import DOCUMENTS, OUTLINE, Heading
from uq.report.layout import laid_out

Source = Callable[[Findings, str], Iterator[Item]]

CONTENTS: Mapping[str, Source] = {
    "context": assessed.context,
    "information": assessed.information,
    "quantities": assessed.quantities,
    "software": assessed.software,
    "models": assessed.models,
    "inputs": assessed.inputs,
    "propagation": found.propagation,
    "convergence": found.convergence,
    "sensitivities": found.sensitivities,
    "uncertainty": found.uncertainty,
    "studies": found.studies,
    "conclusions": found.conclusions,
}
"""Name of a heading -> what a result provides under it."""


class Chapter(NamedTuple):
    """A heading and what is expected under it, provided or not."""

    heading: Heading
    items: list[Item]


def chapters(ds: xr.Dataset, file: str) -> list[Chapter]:
    """Return what a result provides, in the order of the outline.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    file : str
        The name of its file.

    Returns
    -------
    list of Chapter
    """
    findings = Findings(ds)
    return [Chapter(one, list(CONTENTS[one.name](findings, file))) for one in OUTLINE]


def dossier(ds: xr.Dataset, name: str) -> str:
    """Return the dossier of a result as HTML; as `uq.report.page.page` returns its report."""
    return laid_out("dossier/dossier.html", ds, chapters=chapters(ds, name), documents=DOCUMENTS)
