"""Compiled code that numba keeps on disk, apart for each state of the sources it was made from.

numba's own ``cache=True`` looks at the file of a function alone: after an edit of a file that it
calls into, code made from the old one would come back. Here a folder is named by all sources that a
function can come from.
"""

import os
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Self

from platformdirs import user_cache_path

from uq.compilation import when_imported
from uq.study.sources import DISTRIBUTION, digest, is_installed, own_packages, signature, sources_of

_models: set[str] = set()


def keep_apart(module: str) -> None:
    """Have numba keep compiled code so, from now on in this process.

    Parameters
    ----------
    module : str
        In which a model is: what lies in its package counts also where that is installed.
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

    places: list[Any] = FunctionCache._impl_class._locator_classes
    places.insert(0, SourcesLocator)


class SourcesLocator:
    """Where the compiled code of one function is, as numba asks for it.

    Parameters
    ----------
    function : callable
    module : str
        In which it is defined.
    """

    def __init__(self, function: Callable[..., Any], module: str) -> None:
        import numba

        config: Any = numba.config
        base = config.CACHE_DIR or str(user_cache_path(DISTRIBUTION, appauthor=False) / "numba")
        self._path = Path(base) / key_of(module) / module
        self._line = str(function.__code__.co_firstlineno)

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> Self | None:
        """Return the place for a function; None for what is left to numba."""
        module = function.__module__
        if module == "__main__" or not os.path.isfile(file):
            return None
        package = module.partition(".")[0]
        if package in own_packages() or (package not in _models and is_installed(package)):
            return None
        if not sources_of(module).own:
            return None
        found = cls(function, module)
        try:
            found.ensure_cache_path()
        except OSError:
            name = f"{DISTRIBUTION}-numba-{os.getuid()}"
            found._path = Path(tempfile.gettempdir(), name, *found._path.parts[-2:])
            found.ensure_cache_path()
        return found

    def ensure_cache_path(self) -> None:
        """Make the folder, if need be; see that something can be written there."""
        self._path.mkdir(parents=True, exist_ok=True)
        os.utime(self._path.parent)
        tempfile.TemporaryFile(dir=self._path).close()

    def get_cache_path(self) -> str:
        """Return the folder."""
        return str(self._path)

    def get_source_stamp(self) -> str:
        """Return what is to be the same besides the folder: nothing."""
        return ""

    def get_disambiguator(self) -> str:
        """Return what tells functions of one name in one module apart."""
        return self._line


def key_of(module: str) -> str:
    """Return a hash of all that code compiled from a module may come from.

    Parameters
    ----------
    module : str
        Its full name.
    """
    sources = sources_of(module)
    whole = digest(sources.own)
    for package in sorted({name.partition(".")[0] for name in sources.others}):
        whole.update(repr(signature(package, sources.others)).encode())
    return whole.hexdigest()[:16]
