"""Installed models, found through entry points, and a hash of their code.

Rows computed by different code do not form one result. The version of a model is declared by its
author; the hash is computed from the files.
"""

import importlib
import json
import os
import re
import sys
from collections.abc import Mapping
from contextlib import redirect_stdout
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from inspect import isfunction
from pathlib import Path
from types import ModuleType
from typing import Any

from uq.contract import Model
from uq.errors import InputError, choices, described, nearest
from uq.files.whole_files import file_there
from uq.machines.function import is_machine, model_of
from uq.machines.returned import Returned, as_plain, from_plain
from uq.study.compiled_cache import keep_apart
from uq.study.model_files import file_with, hidden_beside, namesake
from uq.study.provenance import provenance
from uq.study.sources import fingerprint, found_at, own_packages

GROUP = "vibrolife.models"

SUFFIX = ".emulator"
"""Ending of the file of an emulator (`uq.machines.emulator`)."""

_MACHINES = (".toml", ".fmu", SUFFIX)
_SERVERS = ("http://", "https://")
_FILE = re.compile(r"(.+\.py)(?::(\w+))?")
_KNOWN_TO_RETURN = "\n"  # in a reference, the declared returns of a function follow it


def model_names() -> tuple[str, ...]:
    """Return the names of all installed models, sorted, without importing any of them."""
    return tuple(sorted(_entry_points()))


FIELD_RECORD = "field-record"
"""Name in a result of what produced lives that were imported: no model."""


def find_model(name: str, folder: Path | None = None) -> Model:
    """Return an installed model by its name.

    The name may come from an untrusted file. Only installed models are imported for it; no file is
    read and no address is called.

    Parameters
    ----------
    name : str
    folder : Path, optional
        Further folder to search for a file with this model, besides the current folder. The file is
        only mentioned in the error, not imported.

    Returns
    -------
    Model

    Raises
    ------
    InputError
        No model of this name is installed, or its package cannot be imported. A broken model does
        not affect the others.
    """
    return _load(_installed(name, folder), f"model '{name}'", None)


def model_at(reference: str) -> Model:
    """Return a model by a reference from the user: ``--model``, or an argument in Python.

    It may run code. `tests/test_architecture.py` lists the modules that may import it: those that
    pass on input of the user. For names in files use `find_model`.

    Parameters
    ----------
    reference : str
        The name of an installed model; ``"package.module:ATTRIBUTE"``; ``"file.py"`` with a model
        or a function decorated by `uq.machines.function.machine` (``"file.py:NAME"`` if there are
        several); ``"file.toml"`` that describes a program or FMU; ``"file.fmu"``; or
        ``"http://host:port/NAME"``.

    Returns
    -------
    Model

    Raises
    ------
    InputError
        The model does not exist, or its package cannot be imported.
    """
    if reference.endswith(SUFFIX):
        from uq.machines.emulator import emulator_model

        return emulator_model(Path(reference), find_model)
    if reference.endswith(_MACHINES):
        from uq.machines.program import machine_of

        return machine_of(Path(reference))
    plain, _, returns = reference.partition(_KNOWN_TO_RETURN)
    returned = from_plain(json.loads(returns)) if returns else None
    if plain.startswith(_SERVERS):
        from uq.machines.server import server_model

        return server_model(plain)
    return _load(_point(plain), f"model '{plain}'", returned)


def with_returns(reference: str, returned: Mapping[str, Returned]) -> str:
    """Return the reference of a function, extended by its declared returns."""
    return f"{without_returns(reference)}{_KNOWN_TO_RETURN}{json.dumps(as_plain(returned))}"


def without_returns(reference: str) -> str:
    """Return a reference without declared returns, as given by the user."""
    return reference.partition(_KNOWN_TO_RETURN)[0]


def located(reference: str) -> str:
    """Return a reference with an absolute path, valid in any folder of this computer."""
    if reference.startswith(_SERVERS):
        return reference
    if reference.endswith(_MACHINES):
        return str(Path(reference).absolute())
    match = _FILE.fullmatch(reference)
    if not match:
        return reference
    return str(Path(match[1]).absolute()) + (f":{match[2]}" if match[2] else "")


def module_of(reference: str) -> str:
    """Return the full name of the module of a model; see `model_at`."""
    return _point(reference).value.partition(":")[0]


def _point(reference: str) -> EntryPoint:
    """Return the entry point of a model, from which it can be imported."""
    reference = without_returns(reference)
    if in_file := _FILE.fullmatch(reference):
        return EntryPoint(reference, f"{_module_in(Path(in_file[1]))}:{in_file[2] or ''}", GROUP)
    if ":" in reference:
        # A model under development is usually in the working folder, which an installed command
        # does not search.
        if os.getcwd() not in sys.path:
            sys.path.append(os.getcwd())
        return EntryPoint(reference, reference, GROUP)
    return _installed(reference)


def _installed(name: str, folder: Path | None = None) -> EntryPoint:
    """Return the entry point of an installed model."""
    installed = _entry_points()
    if name == FIELD_RECORD:
        raise InputError(
            "these are lives from the field, read by 'uq import': no model computes such rows;"
            " 'uq compare' sets them beside a simulated study"
        )
    if name not in installed:
        if file := file_with(name, filter(None, (Path(), folder))):
            raise InputError(
                f"model '{name}' is not installed, but {file} defines it; add --model {file}, or"
                f" give {file} where a model is named"
            )
        names = ", ".join(sorted(installed)) or "none"
        raise InputError(
            f"no such model '{name}'{nearest(name, installed)} (installed: {names};"
            " a model of your own is named by its file, for a study with --model FILE)"
        )
    return installed[name]


def _module_in(file: Path) -> str:
    """Return the name under which the module in a file can be imported."""
    file_there(file)
    folder, name = str(file.absolute().parent), file.stem
    if folder not in sys.path:
        sys.path.append(folder)
    importlib.invalidate_caches()
    spec = find_spec(name) if name.isidentifier() else None
    if not (spec and spec.origin and Path(spec.origin).samefile(file)):
        raise InputError(
            f"{file}: cannot be imported as '{name}', the name of another module or of none;"
            " rename the file"
        )
    return name


def _entry_points() -> dict[str, EntryPoint]:
    return {point.name: point for point in entry_points(group=GROUP)}


def _load(point: EntryPoint, label: str, returned: Mapping[str, Returned] | None) -> Model:
    module_name, _, attribute = point.value.partition(":")
    if not module_name or not (attribute or _FILE.fullmatch(point.name)):
        raise InputError(f"{label}: write it as package.module:ATTRIBUTE")
    package = module_name.partition(".")[0]
    if clash := namesake(package):
        raise InputError(f"{label} cannot be imported: {clash}")
    if _FILE.fullmatch(point.name) and (clash := hidden_beside(module_name)):
        raise InputError(f"{label} {clash}")
    keep_apart(module_name)
    try:
        with redirect_stdout(sys.stderr):  # its output must not mix with results
            module = importlib.import_module(module_name)
        model = getattr(module, attribute or _only_model(module, label))
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        place = f" from {point.value}" if attribute else ""
        problem = described(error)
        if isinstance(error, ModuleNotFoundError):
            problem += f"; {_remedy_of_missing((error.name or '').partition('.')[0])}"
        raise InputError(f"{label} cannot be imported{place}: {problem}") from error
    if package not in own_packages():
        fingerprint(module_name)  # now, before anything is edited
    if is_machine(model):
        model = model_of(model, returned)
    if not isinstance(model, Model):
        remedy = "; write @uq.machine above it" if isfunction(model) else ""
        raise InputError(
            f"{label}: {point.value} is a {type(model).__name__}, not a uq.contract.Model{remedy}"
        )
    _check(model, label)
    return model


def _remedy_of_missing(package: str) -> str:
    """Return the advice for a missing module of a package."""
    if clash := namesake(package):
        return clash
    if place := found_at(package):
        return f"Python finds '{package}' in {place}; if another is meant, rename one of them"
    return "install it, or name its folder in PYTHONPATH"


def _only_model(module: ModuleType, label: str) -> str:
    """Return the name of the only model of a module, or of its only machine."""

    def is_candidate(attribute: Any) -> bool:
        return isinstance(attribute, Model) or (
            is_machine(attribute) and attribute.__module__ == module.__name__
        )

    names = [name for name, attribute in vars(module).items() if is_candidate(attribute)]
    if len(names) == 1:
        return names[0]
    if names:
        raise InputError(f"{label}: has several models; name one, {label}:NAME ({choices(names)})")
    raise InputError(f"{label}: has no model and no function under @uq.machine")


def _check(model: Model, label: str) -> None:
    """Reject a model with undeclared parameters or settings, or with blanks in its labels."""
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
    for name, output in model.outputs.items():
        for category in output.categories:
            if len(category.split()) != 1:  # a result lists them with blanks between
                raise InputError(
                    f"{label}: output '{name}': category '{category}' must be one word"
                )


def made_here(reference: str) -> dict[str, str]:
    """Return the provenance of a model's rows computed here: processor, versions and code.

    Parameters
    ----------
    reference : str
        As for `model_at`.
    """
    return provenance() | {"code": code_of(reference)}


def is_other_code(made: Mapping[str, object], reference: str) -> bool:
    """Return whether rows were computed by code that differs from the installed code.

    Parameters
    ----------
    made : dict
        Provenance of the rows, as recorded by `made_here`; without ``code`` the same code is
        assumed.
    reference : str
        As for `model_at`.
    """
    here = code_of(reference)
    return made.get("code", here) != here


def code_of(reference: str) -> str:
    """Return a hash of the sources of a model: its module and the modules it imports.

    Only sources of its package, and of modules in the same folder, are included.

    Parameters
    ----------
    reference : str
        As for `model_at`.

    Returns
    -------
    str
        Independent of the location of the package; computed once per process, like the import.

    Raises
    ------
    InputError
        The model has no source file.
    """
    if reference.endswith(SUFFIX):
        from uq.machines.emulator import code_of_emulator

        return code_of_emulator(Path(reference))
    if reference.endswith(_MACHINES):
        from uq.machines.program import code_of_machine

        return code_of_machine(Path(reference))
    if reference.startswith(_SERVERS):
        from uq.machines.server import code_of_server

        return code_of_server(without_returns(reference))
    module = module_of(reference)
    if not (digest := fingerprint(module)):
        raise InputError(
            f"model '{reference}': no source file of module '{module}' was found, so its code "
            "cannot be identified; install it, or name its folder in PYTHONPATH"
        )
    return digest
