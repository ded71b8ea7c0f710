"""How kernels are compiled: cached on disk by source, without the GIL, vectorised to full width.

numba keys its cache on the file of the function alone, so an edit to a file that a kernel calls
into would leave stale code. Here the cache folder is named by a hash of every source file under
``models`` and, for a kernel defined elsewhere, of its own package: any edit takes effect at once,
and an unedited package never compiles twice.

What is compiled gives bits that are a function of source and inputs: they depend neither on what
was compiled before, nor on the width of the vectors, nor on who calls.
"""

import hashlib
import inspect
import itertools
import os
import secrets
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from shutil import rmtree
from tempfile import gettempdir
from typing import Any, Literal, TypeVar

from platformdirs import user_cache_path

_KEEP_SECONDS = 30 * 86400


def _ask_for_full_width_vectors() -> None:
    """Let LLVM use 512-bit vectors, before numba reads its environment.

    LLVM prefers 256-bit ones on CPUs that have both; our kernels gain up to 1.8 times. What this
    process compiles for stays in its environment, so that worker processes compile alike.
    """
    if "NUMBA_CPU_FEATURES" in os.environ or "NUMBA_CPU_NAME" in os.environ:
        return
    from llvmlite import binding

    features: Any = binding.get_host_cpu_features()
    flat = features.flatten()
    if features.get("avx512f") and "numba" not in sys.modules:
        flat += ",-prefer-256-bit"
    os.environ["NUMBA_CPU_NAME"] = binding.get_host_cpu_name()
    os.environ["NUMBA_CPU_FEATURES"] = flat


_ask_for_full_width_vectors()
os.environ.setdefault("NUMBA_DISABLE_INTEL_SVML", "1")  # where installed, it has bits of its own

import numba  # noqa: E402  (reads the environment set above)
from numba.core.bytecode import FunctionIdentity  # noqa: E402


def _name_functions_apart() -> None:
    """Let no two processes give two functions one name.

    numba numbers the functions it compiles, from 1 in every process, and tells those of one factory
    apart by that number alone. A process that loads one of them from the cache and compiles another
    under the same number calls the wrong one, without a word: a known fault of numba.
    """
    FunctionIdentity._unique_ids = itertools.count(secrets.randbits(64) << 32)


_name_functions_apart()


_MODELS = Path(__file__).resolve().parent.parent


def _source_hash(roots: Iterable[Path]) -> str:
    """Return a hash of some source files, and of all that lie in some folders."""
    digest = hashlib.sha256()
    for root in roots:
        for path in sorted(root.rglob("*.py")) if root.is_dir() else [root]:
            digest.update(os.fsencode(path.relative_to(root.parent)))
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _cache_folder(*roots: Path) -> Path:
    """Return the cache folder of some sources, made if need be; remove those of old sources."""
    base = user_cache_path("vibrolife", appauthor=False) / "numba"
    try:
        folder = base / _source_hash(roots)
        folder.mkdir(parents=True, exist_ok=True)
        os.utime(folder)
    except OSError:
        base = Path(gettempdir()) / f"vibrolife-numba-{os.getuid()}"
        folder = base / _source_hash(roots)
        folder.mkdir(parents=True, exist_ok=True)
    oldest = time.time() - _KEEP_SECONDS
    for other in base.iterdir():
        with suppress(FileNotFoundError):  # another process may be removing it too
            if other.stat().st_mtime < oldest:
                rmtree(other, ignore_errors=True)
    return folder


CACHE_FOLDER = _cache_folder(_MODELS)


def _folder_of(function: Callable[..., Any]) -> Path:
    """Return the cache folder of a function, wherever it is defined."""
    file = Path(inspect.getfile(function)).resolve()
    if file.is_relative_to(_MODELS) or not file.is_file():
        return CACHE_FOLDER
    return _cache_folder(_MODELS, *_importable_sources(file))


def _importable_sources(file: Path) -> list[Path]:
    """Return the package of a source file; if it has none, what it can import beside it."""
    package, folder = file, file.parent
    while (folder / "__init__.py").is_file():
        package, folder = folder, folder.parent
    if package != file or folder.name in ("site-packages", "dist-packages"):
        return [package]
    return sorted({*folder.glob("*.py"), *(one.parent for one in folder.glob("*/__init__.py"))})


Function = TypeVar("Function", bound=Callable[..., Any])


@contextmanager
def _our_cache_folder(function: Callable[..., Any]) -> Iterator[None]:
    """Point numba at our folder while a function is decorated, and leave the user's be."""
    config: Any = numba.config
    before, config.CACHE_DIR = config.CACHE_DIR, str(_folder_of(function))
    try:
        yield
    finally:
        config.CACHE_DIR = before


def kernel(function: Function) -> Function:
    """Compile a function the way every kernel of this package is compiled.

    ``error_model="numpy"`` drops the division check that blocks vectorisation. There is no fast
    math: a compiler that may fuse or reorder does so differently in code that it inlines and in
    code that it loads from the disk, and the last bits would depend on what was compiled before.
    Products and sums are fused where the source says so, see `models.numerics.fma`.
    """
    return _compiled(function, "never")


def lean(function: Function) -> Function:
    """Compile a kernel that allocates nothing: nobody then counts who holds its arrays.

    Counting is atomic, and takes a third of the time of kernels that make many short calls. What
    Python calls is a `kernel`; this is for what it calls in turn.
    """
    return _compiled(function, "never", _nrt=False)


def inlined(function: Function) -> Function:
    """Compile straight-line algebra into every kernel that calls it, where loops are vectorised."""
    return _compiled(function, "always")


def _compiled(function: Function, inline: Literal["never", "always"], **more: bool) -> Function:
    njit: Any = numba.njit
    with _our_cache_folder(function):
        compiled: Any = njit(
            cache=True,
            nogil=True,
            error_model="numpy",
            inline=inline,
            **more,
        )(function)
    return compiled
