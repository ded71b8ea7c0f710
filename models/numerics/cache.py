"""Where compiled code is cached: in a folder named by a hash of everything it was compiled from.

numba checks only the file that defines a function, so an edit of a file whose functions it calls
would leave stale code. Here the hash covers the whole machine of a function (a package or a module
under ``models``), `models.numerics` and the versions of the compiler: an edit takes effect at once,
and recompiles that machine only. For a function from outside it covers its package and the machines
named there; for one made by a factory also everything it closes over, such as the equations for
which an integrator was made.

The hash does not cover a kernel's arguments: a kernel must not read fields of a named tuple that
another machine declares, but pass it on as it is.
"""

import hashlib
import inspect
import os
import platform
import re
import stat
import time
from codecs import BOM_UTF8
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
        It exists. None if there is no safe place, or if a source was edited since this process
        first asked: modules imported before and after the edit belong to different states of the
        sources.
    """
    roots = {_NUMERICS}.union(*(_roots(file) for file in _files(function, set())))
    whole = hashlib.sha256(repr(_versions()).encode())
    for root in sorted(roots):
        snapshot = _snapshot(root)
        if any(_stamp(path) != stamp for path, stamp in snapshot.stamps.items()):
            return None
        whole.update(snapshot.digest)
    names = sorted(root.stem for root in roots - {_NUMERICS}) or [_NUMERICS.name]
    name = f"{names[0]}-{whole.hexdigest()[:16]}"
    users = user_cache_path("vibrolife", appauthor=False) / "numba"
    if users.is_absolute():  # else there is no home: the path begins with "~"
        with suppress(OSError):
            return _made(users, name)
    try:
        return _made(_private_folder(), name)
    except OSError:
        return None


def _private_folder() -> Path:
    """Make a folder for temporary files that nobody else can write in.

    Compiled code is loaded by unpickling: who writes it has it run. Anyone may have made a folder
    of this name before.

    Raises
    ------
    PermissionError
        When it is not ours alone.
    """
    folder = Path(gettempdir()) / f"vibrolife-numba-{os.getuid()}"
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    look = folder.lstat()
    if not stat.S_ISDIR(look.st_mode) or look.st_uid != os.getuid() or look.st_mode & 0o077:
        raise PermissionError(f"{folder} is not a folder of this user alone")
    return folder


def _files(value: Any, seen: set[int]) -> Iterator[Path]:
    """Yield the files of functions and named tuples, and of everything they close over."""
    value = getattr(value, "py_func", value)
    if id(value) in seen:
        return
    seen.add(id(value))
    if inspect.isfunction(value) or hasattr(value, "_fields"):
        with suppress(TypeError, OSError):  # defined in no file
            owner = value if callable(value) else type(value)
            yield Path(inspect.getfile(owner)).resolve(strict=True)
    if isinstance(value, tuple | list):
        for member in value:
            yield from _files(member, seen)
    for cell in getattr(value, "__closure__", None) or ():
        with suppress(ValueError):  # not assigned yet
            yield from _files(cell.cell_contents, seen)


def _roots(file: Path) -> set[Path]:
    """Return the packages and modules whose functions a file may call."""
    if _is_ours(file):
        return {_MODELS / file.relative_to(_MODELS).parts[0]}
    roots = _importable(file)
    words = frozenset().union(*(_words(root) for root in roots))
    named = (part for part in _MODELS.iterdir() if os.fsencode(part.stem) in words)
    return {*roots, *(named if os.fsencode(_MODELS.name) in words else ())}


def _importable(file: Path) -> set[Path]:
    """Return the package of a source file; without one, the modules and packages beside it."""
    package, folder = file, file.parent
    while (folder / "__init__.py").is_file():
        package, folder = folder, folder.parent
    if package != file or folder.name in _INSTALLED:
        return {package}
    return {*folder.glob("*.py"), *(init_file.parent for init_file in folder.glob("*/__init__.py"))}


def _is_ours(path: Path) -> bool:
    return path.is_relative_to(_MODELS)


class _Snapshot(NamedTuple):
    """A source file, or all those in a folder, as this process first saw them."""

    digest: bytes
    sources: tuple[bytes, ...]
    stamps: dict[Path, tuple[int, int]]


@cache
def _words(root: Path) -> frozenset[bytes]:
    return frozenset(re.findall(rb"\w+", b"\n".join(_snapshot(root).sources)))


@cache
def _snapshot(root: Path) -> _Snapshot:
    whole, sources, stamps = hashlib.sha256(), [], {}
    for path in filter(Path.is_file, sorted(root.rglob("*.py")) if root.is_dir() else [root]):
        stamps[path] = _stamp(path)
        source = path.read_bytes().removeprefix(BOM_UTF8).replace(b"\r\n", b"\n")
        whole.update(b"%s %d\n" % (os.fsencode(path.relative_to(root.parent)), len(source)))
        whole.update(source)
        sources.append(source)
    return _Snapshot(whole.digest(), tuple(sources), stamps)


def _stamp(path: Path) -> tuple[int, int]:
    """Return a file's modification time and size, which an edit changes; zeros without a file."""
    try:
        look = os.stat(path)
    except FileNotFoundError:
        return 0, 0
    return look.st_mtime_ns, look.st_size


@cache
def _versions() -> tuple[str, ...]:
    """Return the versions of everything that turns sources and constants into code."""
    import llvmlite
    import numba
    import numpy as np

    return platform.python_version(), numba.__version__, llvmlite.__version__, np.__version__


@cache
def _made(base: Path, name: str) -> Path:
    """Make a folder unless it exists; remove those not used for a while."""
    folder = base / name
    folder.mkdir(parents=True, exist_ok=True)
    os.utime(folder)
    oldest = time.time() - _KEEP_SECONDS
    for other in base.iterdir():
        with suppress(FileNotFoundError):  # another process may be removing it too
            if other.stat().st_mtime < oldest:
                rmtree(other, ignore_errors=True)
    return folder
