"""The models installed here, found through entry points, and a hash of their code.

Rows computed by different code do not form one result. The version of a model is its author's
promise; the hash comes from the files.
"""

import importlib
import os
import sys
from collections.abc import Mapping
from importlib.metadata import EntryPoint, entry_points

from uq.contract import Model
from uq.errors import InputError, nearest
from uq.provenance import provenance
from uq.study.compiled import keep_apart, own_packages
from uq.study.sources import fingerprint

GROUP = "vibrolife.models"


def model_names() -> tuple[str, ...]:
    """Return the names of all installed models, sorted, without importing any of them."""
    return tuple(sorted(_entry_points()))


def find_model(reference: str) -> Model:
    """Return a model by its name or, while it is being written, by its place in a package.

    Parameters
    ----------
    reference : str
        The name of an installed model, or ``"package.module:ATTRIBUTE"``.

    Returns
    -------
    Model

    Raises
    ------
    InputError
        There is no such model, or its package cannot be imported. A broken model does not affect
        the others.
    """
    return _load(_point(reference), f"model '{reference}'")


def module_of(reference: str) -> str:
    """Return the full name of the module of a model; see `find_model`."""
    return _point(reference).value.partition(":")[0]


def _point(reference: str) -> EntryPoint:
    """Return the place of a model, from which it can be imported."""
    if ":" in reference:
        # A model under development is usually in the working folder, which an installed command
        # does not search.
        if os.getcwd() not in sys.path:
            sys.path.append(os.getcwd())
        return EntryPoint(reference, reference, GROUP)
    installed = _entry_points()
    if reference not in installed:
        names = ", ".join(sorted(installed)) or "none"
        raise InputError(
            f"no such model '{reference}'{nearest(reference, installed)} (installed: {names})"
        )
    return installed[reference]


def _entry_points() -> dict[str, EntryPoint]:
    return {point.name: point for point in entry_points(group=GROUP)}


def _load(point: EntryPoint, label: str) -> Model:
    module_name, _, attribute = point.value.partition(":")
    if not module_name or not attribute:
        raise InputError(f"{label}: write it as package.module:ATTRIBUTE")
    keep_apart(module_name)
    try:
        found = getattr(importlib.import_module(module_name), attribute)
    except (Exception, SystemExit) as error:
        problem = f"{type(error).__name__}: {' '.join(str(error).split())}"
        if isinstance(error, ModuleNotFoundError):
            problem += "; install it, or name its folder in PYTHONPATH"
        raise InputError(f"{label} cannot be imported from {point.value}: {problem}") from error
    if module_name.partition(".")[0] not in own_packages():
        fingerprint(module_name)  # now, before anything is edited
    if not isinstance(found, Model):
        raise InputError(
            f"{label}: {point.value} is a {type(found).__name__}, not a uq.contract.Model"
        )
    _check(found, label)
    return found


def _check(model: Model, label: str) -> None:
    """Refuse a model whose parameters or settings are not declared."""
    try:
        for name in model.parameter_names:
            model.parameter(name)
        for name in model.setting_names:
            model.setting(name)
        missing = set(model.parameter_names) - set(model.nominal)
        model.settings()
    except (TypeError, AttributeError, NameError) as error:
        raise InputError(f"{label}: {error}") from None
    if missing:
        raise InputError(f"{label}: parameter '{min(missing)}' has no nominal value")


def made_here(reference: str) -> dict[str, str]:
    """Return what determines the rows of a model here: processor, versions and the model's code.

    Parameters
    ----------
    reference : str
        As for `find_model`.
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
        As for `find_model`.

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
