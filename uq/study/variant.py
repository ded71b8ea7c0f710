"""A variant of a study: the same inputs and model under another design and name."""

from typing import Any

from uq.errors import InputError, nearest
from uq.sampling.designs import DESIGNS, PLAIN, Design
from uq.study.definition import Study

REPLICATES = 8
"""Replicates of a design for indices, so that its indices have intervals."""

_ROWS = 8192
"""Approximate number of rows of a design for indices."""

_FEWEST = 16  # points of a replicate


def variant(study: Study, method: str | None = None, name: str | None = None) -> str:
    """Return the file of a study with another design, without comments.

    A design whose rows are not independent gets eight replicates, for intervals; its number of
    samples is a power of two. Tolerance bounds, which assume independent rows, and sensitivity
    methods of the design before are left out.

    Parameters
    ----------
    study : Study
    method : str, optional
        By default the design of the study.
    name : str, optional
        By default the name of the study, followed by the design.

    Returns
    -------
    str
        TOML.

    Raises
    ------
    InputError
        When there is no such design, or the study cannot have it.
    """
    changes: dict[str, Any] = {}
    if method is not None:
        refuse_unknown(method)
        changes["design.method"] = method
        changes |= _for_design(study, method)
    changes["study.name"] = name or f"{study.name}-{method or 'copy'}"
    return study.with_changes(changes).text


def refuse_unknown(method: str) -> None:
    """Raise `InputError` if there is no such design."""
    if method not in DESIGNS:
        allowed = ", ".join(DESIGNS)
        raise InputError(
            f"--design {method}: no such design{nearest(method, DESIGNS)} (allowed: {allowed})"
        )


def _for_design(study: Study, method: str) -> dict[str, Any]:
    """Return the changes that another design needs."""
    design, given, asked = DESIGNS[method], study.design, study.analysis
    changes: dict[str, Any] = {}
    if asked.sensitivity:  # chosen for the design before
        changes["analysis.sensitivity"] = None
    if design.independent:
        return changes
    for bound in ("tolerance", "joint_bounds"):  # their confidence assumes independent rows
        if getattr(asked, bound):
            changes[f"analysis.{bound}"] = None
    group = design.blocks(len(study.uncertain), given.second_order, study.random)
    changes["design.samples"] = samples_of(design, group, given.samples * given.replicates)
    changes["design.replicates"] = REPLICATES
    if given.until is not None and design.layout is not PLAIN:
        changes["design.until"] = None
    return changes


def samples_of(design: Design, group: int, plain_rows: int) -> int:
    """Return a power of two of samples of each replicate.

    Parameters
    ----------
    design : Design
    group : int
        Rows of a sample.
    plain_rows : int
        Wanted number of rows in all, of a design that is not for indices.
    """
    rows = _ROWS if design.layout is not PLAIN else plain_rows
    fitting = max(rows // (REPLICATES * group), design.least, _FEWEST)
    return int(2 ** (fitting - 1).bit_length())
