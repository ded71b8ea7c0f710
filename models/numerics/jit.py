"""How kernels are compiled: cached on disk by source, without the GIL, vectorised to full width.

Compiled code is cached by `models.numerics.cache`: an edit takes effect at once, and an unedited
machine never compiles twice.

The bits of a result are a function of source and inputs: they depend neither on what was compiled
before, nor on the vector width, nor on the caller.
"""

import inspect
import itertools
import secrets
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, partial
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core.bytecode import FunctionIdentity
from numba.core.caching import Cache
from numba.core.runtime import rtsys
from numba.core.targetconfig import TargetConfig

from models.numerics.cache import folder_of


def _name_functions_apart() -> None:
    """Prevent two processes from giving two functions the same name.

    numba numbers the functions it compiles, from 1 in every process, and distinguishes those made
    by one factory by that number alone. A process that loads one of them from the cache and
    compiles another under the same number silently calls the wrong one: a known bug of numba.
    """
    FunctionIdentity._unique_ids = itertools.count(secrets.randbits(64) << 32)


def _compare_options_quickly() -> None:
    """Prevent numba from spending a tenth of its time on comparing the options of kernels.

    Each operator of a source is looked up under the options of its kernel, thirty properties, which
    numba reads one by one.
    """

    @cache
    def defaults(kind: Any) -> dict[str, Any]:
        return {name: option.default for name, option in kind.options.items()}

    def values(self: Any) -> dict[str, Any]:
        kind: Any = type(self)
        return defaults(kind) | self._values

    patched: Any = TargetConfig
    patched.values = values


def _do_without_cache_on_full_disks() -> None:
    """Prevent a row from failing because its compiled code cannot be kept for the next process."""
    save: Any = Cache.save_overload

    def saved(self: Any, signature: Any, data: Any) -> None:
        with suppress(OSError):
            save(self, signature, data)

    patched: Any = Cache
    patched.save_overload = saved


def _load_without_compiler(compiled: Any) -> None:
    """Prevent numba from importing its library of typed functions only to load a kernel.

    The import takes longer than a row. numba repeats it before it compiles, where it is needed.
    """
    cache: Any = compiled._cache

    def load(signature: Any, context: Any) -> Any:
        rtsys.initialize(context)
        with cache._guard_against_spurious_io_errors():
            return cache._load_overload(signature, context)

    cache.load_overload = load


_name_functions_apart()
_do_without_cache_on_full_disks()
_compare_options_quickly()


Function = TypeVar("Function", bound=Callable[..., Any])


@contextmanager
def _cache_folder(folder: Path) -> Iterator[None]:
    """Point numba to our folder while a function is decorated, then restore the user's."""
    config: Any = numba.config
    before, config.CACHE_DIR = config.CACHE_DIR, str(folder)
    try:
        yield
    finally:
        config.CACHE_DIR = before


def kernel(function: Function) -> Function:
    """Compile a function as every kernel of this package is compiled.

    ``error_model="numpy"`` drops the check for division by zero, which blocks vectorisation.
    Fast-math flags are not used: a compiler that may fuse or reorder does so differently in code
    that it inlines and in code that it loads from disk, and the last bits would depend on what was
    compiled before. Products and sums are fused where the source says so; see
    `models.numerics.fma`.
    """
    return _compiled(function)


def lean(function: Function) -> Function:
    """Compile a kernel that allocates nothing, without reference counting.

    Counting is atomic, and takes a third of the time of kernels that make many short calls. Use it
    for functions that a `kernel` calls; what Python calls must be a `kernel`.
    """
    return _compiled(function, _nrt=False)


def inlined(function: Function) -> Function:
    """Compile straight-line algebra into every calling kernel, so that its loops vectorise.

    LLVM does so. Where numba inlines instead, it types every copy anew, which takes seconds.
    """
    return _compiled(function, _nrt=False, forceinline=True)


def spliced(function: Function) -> Function:
    """Inline the functions that a kernel calls, before types are inferred.

    The machine code of a kernel contains that of all it calls, also where it is itself only called:
    in a tower of kernels, every storey is compiled again. This one is not.
    """
    return _compiled(function, inline="always")


_of_modules: dict[tuple[int, str], tuple[object, Path | None]] = {}


def _folder_of(function: Callable[..., Any]) -> Path | None:
    """Return the folder for compiled code, asked for once for all plain functions of a module.

    A module that is loaded again, as after an edit, has another specification.
    """
    spec = function.__globals__.get("__spec__")
    if spec is None or "." in function.__qualname__:  # the latter may close over others
        return folder_of(function)
    key = id(spec), function.__code__.co_filename
    if key not in _of_modules:
        _of_modules[key] = spec, folder_of(function)
    return _of_modules[key][1]


def _compiled(function: Function, **more: Any) -> Function:
    more |= {"no_cfunc_wrapper": True}  # nobody calls a kernel from C
    decorate: Any = partial(numba.njit, nogil=True, error_model="numpy", **more)
    typed_in = not Path(inspect.getfile(function)).is_file()  # an edit would go unnoticed
    folder = None if typed_in else _folder_of(function)
    if folder is None:
        return decorate()(function)
    with _cache_folder(folder):
        compiled = decorate(cache=True)(function)
    if hasattr(compiled, "_cache"):  # else kernels are not compiled at all
        _load_without_compiler(compiled)
    return compiled
