"""The code of a model, as one number: what two codes have computed is no one result.

A model's version is its author's promise; this is what the files say.
"""

from collections.abc import Mapping

from uq.errors import InputError
from uq.provenance import provenance
from uq.study.registry import module_of
from uq.study.sources import fingerprint


def made_here(reference: str) -> dict[str, str]:
    """Return what makes the rows of a model here: processor, versions and the model's code.

    Parameters
    ----------
    reference : str
        What `uq.study.registry.find_model` finds the model by.
    """
    return provenance() | {"code": code_of(reference)}


def is_other_code(made: Mapping[str, object], reference: str) -> bool:
    """Return whether rows were made by other code than is here.

    Parameters
    ----------
    made : dict
        What made them, as `made_here` told then; without ``code``, nothing is known.
    reference : str
        As above.
    """
    here = code_of(reference)
    return made.get("code", here) != here


def code_of(reference: str) -> str:
    """Return a hash of the sources of a model: its module, and what that imports.

    Counted are sources of its package, and of what lies beside that in the same folder.

    Parameters
    ----------
    reference : str
        What `uq.study.registry.find_model` finds the model by.

    Returns
    -------
    str
        The same wherever the package lies. Once asked for it stays, as does what was imported.

    Raises
    ------
    InputError
        When no source is found.
    """
    module = module_of(reference)
    if not (found := fingerprint(module)):
        raise InputError(
            f"model '{reference}': no source file of module '{module}' was found, so its code "
            "cannot be identified; install it, or name its folder in PYTHONPATH"
        )
    return found
