"""Where compiled code is kept: in a folder named by a hash of all that it was made from.

numba looks at the file of a function alone, so that an edit of a file that it calls into would
leave stale code. What counts here is the whole machine of a function, be it a package or a module
under ``models``, with `models.numerics` and the versions of what compiles: an edit takes effect at
once, and compiles this machine alone. A function from elsewhere counts with its package and the
machines that this names. What a factory makes counts with all that it closes over, such as the
equations that an integrator was made for.

A kernel knows no field of a named tuple that another machine declares: it is passed on as it is.
"""

import hashlib
import inspect
import os
import platform
import re
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from shutil import rmtree
from tempfile import gettempdir
from typing import Any

from platformdirs import user_cache_path

_NUMERICS = Path(__file__).resolve().parent
_MODELS = _NUMERICS.parent
_INSTALLED = ("site-packages", "dist-packages")
_KEEP_SECONDS = 30 * 86400


def folder_of(function: Callable[..., Any]) -> Path:
    """Return the folder for the compiled code of a function that a file defines.

    Parameters
    ----------
    function : callable
        Not compiled yet.

    Returns
    -------
    Path
        It exists.
    """
    roots = {_NUMERICS}.union(*(_roots(file) for file in _files(function, set())))
    whole = hashlib.sha256(repr(_versions()).encode())
    for root in sorted(roots):
        whole.update(_kept_hash(root) if _is_ours(root) else _hash(root))
    names = sorted(root.stem for root in roots - {_NUMERICS}) or [_NUMERICS.name]
    name = f"{names[0]}-{whole.hexdigest()[:16]}"
    try:
        return _made(user_cache_path("vibrolife", appauthor=False) / "numba", name)
    except OSError:
        return _made(Path(gettempdir()) / f"vibrolife-numba-{os.getuid()}", name)


def _files(value: Any, seen: set[int]) -> Iterator[Path]:
    """Yield the files of a function, a named tuple or several, and of what they close over."""
    value = getattr(value, "py_func", value)
    if id(value) in seen:
        return
    seen.add(id(value))
    if inspect.isfunction(value) or hasattr(value, "_fields"):
        with suppress(TypeError, OSError):  # nobody wrote it into a file
            owner = value if callable(value) else type(value)
            yield Path(inspect.getfile(owner)).resolve(strict=True)
    if isinstance(value, tuple | list):
        for one in value:
            yield from _files(one, seen)
    for cell in getattr(value, "__closure__", None) or ():
        with suppress(ValueError):  # to be filled later
            yield from _files(cell.cell_contents, seen)


def _roots(file: Path) -> set[Path]:
    """Return the packages and modules in which the functions of a file may find others."""
    if _is_ours(file):
        return {_MODELS / file.relative_to(_MODELS).parts[0]}
    own = _importable(file)
    words = {word for root in own for one in _sources(root) for word in _words(one)}
    named = (part for part in _MODELS.iterdir() if part.stem in words)
    return {*own, *(named if _MODELS.name in words else ())}


def _importable(file: Path) -> set[Path]:
    """Return the package of a source file; if it has none, what it can import beside it."""
    package, folder = file, file.parent
    while (folder / "__init__.py").is_file():
        package, folder = folder, folder.parent
    if package != file or folder.name in _INSTALLED:
        return {package}
    return {*folder.glob("*.py"), *(one.parent for one in folder.glob("*/__init__.py"))}


def _is_ours(path: Path) -> bool:
    return path.is_relative_to(_MODELS)


def _sources(root: Path) -> list[Path]:
    return sorted(root.rglob("*.py")) if root.is_dir() else [root]


def _words(file: Path) -> list[str]:
    return re.findall(r"\w+", file.read_text(errors="replace"))


def _hash(root: Path) -> bytes:
    """Return a hash of a source file, or of all that lie in a folder."""
    whole = hashlib.sha256()
    for path in _sources(root):
        source = path.read_bytes()
        whole.update(b"%s %d\n" % (os.fsencode(path.relative_to(root.parent)), len(source)))
        whole.update(source)
    return whole.digest()


_kept_hash = cache(_hash)


@cache
def _versions() -> tuple[str, ...]:
    """Return the versions of what turns sources and constants into code."""
    import llvmlite
    import numba
    import numpy as np

    return platform.python_version(), numba.__version__, llvmlite.__version__, np.__version__


@cache
def _made(base: Path, name: str) -> Path:
    """Make a folder, if need be; remove those that no process has asked for in a while."""
    folder = base / name
    folder.mkdir(parents=True, exist_ok=True)
    os.utime(folder)
    oldest = time.time() - _KEEP_SECONDS
    for other in base.iterdir():
        with suppress(FileNotFoundError):  # another process may be removing it too
            if other.stat().st_mtime < oldest:
                rmtree(other, ignore_errors=True)
    return folder
