"""A hash of the code of a model: rows computed by different code do not form one result.

The version of a model is its author's promise; the hash comes from the files.
"""

from collections.abc import Mapping

from uq.errors import InputError
from uq.provenance import provenance
from uq.study.registry import module_of
from uq.study.sources import fingerprint


def made_here(reference: str) -> dict[str, str]:
    """Return what determines the rows of a model here: processor, versions and the model's code.

    Parameters
    ----------
    reference : str
        As for `uq.study.registry.find_model`.
    """
    return provenance() | {"code": code_of(reference)}


def is_other_code(made: Mapping[str, object], reference: str) -> bool:
    """Return whether rows were computed by code other than that installed here.

    Parameters
    ----------
    made : dict
        What determined them, as recorded by `made_here`; without ``code``, nothing is known.
    reference : str
        As above.
    """
    here = code_of(reference)
    return made.get("code", here) != here


def code_of(reference: str) -> str:
    """Return a hash of the sources of a model: its module, and what that imports.

    Only the sources of its package, and of its neighbours in the same folder, count.

    Parameters
    ----------
    reference : str
        As for `uq.study.registry.find_model`.

    Returns
    -------
    str
        Independent of where the package lies. It is computed once per process, like the import.

    Raises
    ------
    InputError
        No source was found.
    """
    module = module_of(reference)
    if not (found := fingerprint(module)):
        raise InputError(
            f"model '{reference}': no source file of module '{module}' was found, so its code "
            "cannot be identified; install it, or name its folder in PYTHONPATH"
        )
    return found
