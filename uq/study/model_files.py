"""User files that define a model, or that have the name of one of our packages."""

import ast
import os
import shlex
import tomllib
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

from uq.files.whole_files import node
from uq.study.sources import DISTRIBUTION, INSTALLED, found_at, own_packages, sources_of

_LARGEST = 1_000_000  # largest size of a searched file in bytes
_MOST = 300  # most files searched in a folder


def file_with(model: str, folders: Iterable[Path]) -> str:
    """Return the shell-quoted reference of the first file with this model; "" if there is none.

    Parameters
    ----------
    model : str
    folders : iterable of Path

    Returns
    -------
    str
        Reference for ``--model``: ``pad.py``, ``machines.py:pad`` or ``pad.toml``.
    """
    for folder in dict.fromkeys(folders):
        with suppress(OSError):
            files = sorted(path for path in folder.iterdir() if path.suffix in _NAMED)[:_MOST]
            for path in files:
                if reference := _reference(path, model):
                    return shlex.quote(reference)
    return ""


def shortened(reference: str) -> str:
    """Return a shell-quoted reference, relative to the current folder if the file is in it."""
    return shlex.quote(reference.removeprefix(f"{os.getcwd()}{os.sep}"))


def _reference(path: Path, model: str) -> str:
    """Return the reference to a model in a file; "" if the file does not define it."""
    if node(path) or path.stat().st_size > _LARGEST:
        return ""
    content = path.read_bytes()
    if model.encode() not in content:
        return ""
    # Unfinished files may be invalid, and ast fails for deeply nested ones.
    with suppress(SyntaxError, ValueError, RecursionError, MemoryError):
        return _NAMED[path.suffix](path, content, model)
    return ""


def _in_python(path: Path, content: bytes, model: str) -> str:
    """Return the reference to a function under ``@uq.machine`` or a `Model` in Python source."""
    names = dict(filter(None, map(_named, ast.parse(content).body)))
    if model not in names:
        return ""
    return str(path) if len(names) == 1 else f"{path}:{names[model]}"


def _named(statement: ast.stmt) -> tuple[str, str] | None:
    """Return the name of the model that a statement defines, and the name of its variable."""
    match statement:
        case ast.FunctionDef(name=name, decorator_list=marks) if "machine" in map(_callee, marks):
            return name, name
        case (
            ast.Assign(targets=[ast.Name(id=variable)], value=ast.Call() as call)
            | ast.AnnAssign(target=ast.Name(id=variable), value=ast.Call() as call)
        ) if _callee(call) == "Model":
            given = [*call.args[:1], *(key.value for key in call.keywords if key.arg == "name")]
            value: Any = given[0] if given else None
            return str(getattr(value, "value", "")), variable
    return None


def _callee(expression: ast.expr) -> str:
    """Return the last part of the name of a decorator or called function."""
    called = expression.func if isinstance(expression, ast.Call) else expression
    return getattr(called, "attr", getattr(called, "id", ""))


def _in_machine_file(path: Path, content: bytes, model: str) -> str:
    machine = tomllib.loads(content.decode("utf-8-sig")).get("machine")
    return str(path) if isinstance(machine, dict) and machine.get("name") == model else ""


_NAMED = {".py": _in_python, ".toml": _in_machine_file}


_HOUSE = Path(__file__).parents[2]  # our packages are in one folder for any kind of installation


def namesake(package: str) -> str:
    """Return a message if another package hides the package of one of our models.

    Parameters
    ----------
    package : str
        Package of a model.

    Returns
    -------
    str
        Sentence with both locations; "" if Python finds our package.
    """
    first, ours = found_at(package), _HOUSE / package
    if package not in own_packages() or not ours.is_dir() or first is None or _is_same(first, ours):
        return ""
    installed = first.parent.name in INSTALLED
    remedy = "uninstall" if installed else "rename"
    other = "in another environment" if installed else "in another folder"
    return (
        f"{first} is another '{package}' than that of {DISTRIBUTION}, {ours}, and Python finds it"
        f" first; {remedy} it, or work {other}"
    )


def hidden_beside(module: str) -> str:
    """Return a message if our package hides a file that a neighbouring module imports.

    Parameters
    ----------
    module : str
        Module of a model in a file.

    Returns
    -------
    str
        Sentence with both locations; "" if Python finds the intended file.
    """
    code, others = sources_of(module)
    names = [name.split(".") for name in (*code, *others)]
    place = found_at(module.partition(".")[0])
    for package in sorted(own_packages() & {first for first, *_ in names}):
        ours = _HOUSE / package
        modules = {rest[0] for first, *rest in names if first == package and rest}
        if place is None or namesake(package) or modules & {p.stem for p in ours.iterdir()}:
            continue
        for beside in (place.with_name(f"{package}.py"), place.with_name(package)):
            if beside.exists() and not _is_same(beside, ours):
                return (
                    f"imports '{package}', which Python finds in {ours} of {DISTRIBUTION}, not in"
                    f" {beside}; rename the latter"
                )
    return ""


def _is_same(first: Path, second: Path) -> bool:
    return os.path.realpath(first) == os.path.realpath(second)
