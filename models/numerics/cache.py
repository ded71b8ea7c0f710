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
from typing import Any, NamedTuple

from platformdirs import user_cache_path

_NUMERICS = Path(__file__).resolve().parent
_MODELS = _NUMERICS.parent
_INSTALLED = ("site-packages", "dist-packages")
_KEEP_SECONDS = 30 * 86400


def folder_of(function: Callable[..., Any]) -> Path | None:
    """Return the folder for the compiled code of a function that a file defines.

    Parameters
    ----------
    function : callable
        Not compiled yet.

    Returns
    -------
    Path or None
        It exists. None where a source was edited since this process first asked: what it imported
        before and what it imports now are of no one state of the sources.
    """
    roots = {_NUMERICS}.union(*(_roots(file) for file in _files(function, set())))
    whole = hashlib.sha256(repr(_versions()).encode())
    for root in sorted(roots):
        found = _snapshot(root)
        if any(_stamp(path) != stamp for path, stamp in found.stamps.items()):
            return None
        whole.update(found.digest)
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
    words = frozenset().union(*(_snapshot(root).words for root in own))
    named = (part for part in _MODELS.iterdir() if os.fsencode(part.stem) in words)
    return {*own, *(named if os.fsencode(_MODELS.name) in words else ())}


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


class _Snapshot(NamedTuple):
    """A source file, or all that lie in a folder, as this process first saw them."""

    digest: bytes
    words: frozenset[bytes]
    stamps: dict[Path, tuple[int, int]]


@cache
def _snapshot(root: Path) -> _Snapshot:
    whole, words, stamps = hashlib.sha256(), set[bytes](), {}
    for path in filter(Path.is_file, sorted(root.rglob("*.py")) if root.is_dir() else [root]):
        stamps[path] = _stamp(path)
        source = path.read_bytes()
        whole.update(b"%s %d\n" % (os.fsencode(path.relative_to(root.parent)), len(source)))
        whole.update(source)
        words.update(re.findall(rb"\w+", source))
    return _Snapshot(whole.digest(), frozenset(words), stamps)


def _stamp(path: Path) -> tuple[int, int]:
    """Return what an edit changes: the time of a file and its size, or zeros if it is gone."""
    try:
        look = os.stat(path)
    except FileNotFoundError:
        return 0, 0
    return look.st_mtime_ns, look.st_size


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
