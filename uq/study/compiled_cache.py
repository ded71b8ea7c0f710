"""numba's cache on disk, with a separate folder for each state of the sources."""

import atexit
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Self

from uq.files.whole_files import cache_path
from uq.machines.compilation import when_imported
from uq.study.sources import DISTRIBUTION, digest, is_installed, own_packages, signature, sources_of

_models: set[str] = set()


def keep_apart(module: str) -> None:
    """Make numba use `SourcesLocator` for its disk cache in this process from now on.

    Parameters
    ----------
    module : str
        Module of a model: its package is included even if it is installed.
    """
    _models.add(module.partition(".")[0])
    _watch()


@cache
def _watch() -> None:
    if "numba" in sys.modules:
        _install()
    else:
        when_imported("numba", _install)


def _install() -> None:
    from numba.core.caching import FunctionCache

    FunctionCache._impl_class._locator_classes.insert(0, SourcesLocator)


@cache
def _fresh_folder() -> Path:
    """Return a new private folder of this process, since numba unpickles the files in it."""
    folder = tempfile.mkdtemp(prefix=f"{DISTRIBUTION}-numba-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


class SourcesLocator:
    """Cache locator of numba: the folder of the compiled code of one function.

    numba's own ``cache=True`` checks only the file of a function. After an edit of another file
    that the function calls, it would load stale code. Here the name of the folder is a hash of all
    sources on which a function can depend.

    Parameters
    ----------
    function : callable
    module : str
        The module that defines it.
    """

    def __init__(self, function: Callable[..., Any], module: str) -> None:
        import numba

        config: Any = numba.config
        users = config.CACHE_DIR or cache_path(DISTRIBUTION) / "numba"
        self._path = Path(users) / key_of(module) / module
        self._line = str(function.__code__.co_firstlineno)

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> Self | None:
        """Return the locator for a function; None to use numba's default."""
        module = function.__module__
        if module == "__main__" or not os.path.isfile(file):
            return None
        package = module.partition(".")[0]
        if package in own_packages() or (package not in _models and is_installed(package)):
            return None
        if not sources_of(module)[0]:
            return None
        locator = cls(function, module)
        try:
            locator.ensure_cache_path()
        except OSError:
            locator._path = _fresh_folder().joinpath(*locator._path.parts[-2:])
            locator.ensure_cache_path()
        return locator

    def ensure_cache_path(self) -> None:
        """Create the folder if necessary, and check that it is writable."""
        self._path.mkdir(parents=True, exist_ok=True)
        os.utime(self._path.parent)
        tempfile.TemporaryFile(dir=self._path).close()

    def get_cache_path(self) -> str:
        """Return the folder."""
        return str(self._path)

    def get_source_stamp(self) -> str:
        """Return an empty stamp: the name of the folder already identifies the sources."""
        return ""

    def get_disambiguator(self) -> str:
        """Return the line number of the function, to distinguish functions of the same name."""
        return self._line


def key_of(module: str) -> str:
    """Return a hash of all sources on which the compiled code of a module can depend.

    Parameters
    ----------
    module : str
        Full name of the module.
    """
    code, others = sources_of(module)
    whole = digest(code)
    for package in sorted({name.partition(".")[0] for name in others}):
        whole.update(repr(signature(package, others)).encode())
    return whole.hexdigest()[:16]
