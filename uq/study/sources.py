"""The source files that a module of a model consists of: its own, and what it imports.

That is its package, and what it imports of packages that are not installed, wherever they lie. What
is installed in other packages has a version; the platform itself is no part of any model.
"""

import ast
import hashlib
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Set
from functools import cache, lru_cache
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.metadata import entry_points
from importlib.util import find_spec, resolve_name
from pathlib import Path
from typing import NamedTuple

DISTRIBUTION = "vibrolife"
_INSTALLED = ("site-packages", "dist-packages")
_PLATFORM = __name__.partition(".")[0]
_COMPUTED = "*"  # a module whose name is known when the import is carried out
_IMPORTERS = ("import_module", "__import__")
_FILES = ("/__init__.py", ".py", *EXTENSION_SUFFIXES)


class Sources(NamedTuple):
    """What a module is made from.

    Attributes
    ----------
    own : dict of str to bytes
        Module -> its source, or the machine code of an extension; empty if none was found.
    root : Path or None
        The folder in which the package lies.
    others : set of str
        Modules from elsewhere that they import.
    """

    own: dict[str, bytes]
    root: Path | None
    others: set[str]


def sources_of(module: str) -> Sources:
    """Return what a module is made from: its source and those that it imports, in turn.

    Parameters
    ----------
    module : str
        Its full name; it can be imported, and need not be yet.
    """
    package = module.partition(".")[0]
    root = _root(package)
    found: dict[str, bytes] = {}
    others: set[str] = set()
    if root is None:
        return Sources(found, root, others)
    beside = root.name not in _INSTALLED
    todo, seen = {module}, set()
    while todo:
        name = todo.pop()
        seen.add(name)
        first = name.partition(".")[0]
        home = root if first == package or (beside and _is_module(root, first)) else _edited(first)
        if home is None:
            others.add(name)
            continue
        for ending in _FILES:
            file = Path(f"{home.joinpath(*name.split('.'))}{ending}")
            if name not in found and file.is_file():
                found[name] = file.read_bytes()
                above = name.rpartition(".")[0]
                within = name if ending == _FILES[0] else above
                inside = set(_imported(found[name], within)) if ending.endswith(".py") else set()
                if _COMPUTED in inside:
                    inside |= _modules(home, first)
                todo |= {above or name, *inside} - seen
        todo = {name for name in todo if name.partition(".")[0] != _PLATFORM}
    return Sources(found, root, others)


@cache
def fingerprint(module: str) -> str:
    """Return a hash of the sources of a module, see `sources_of`; "" if none was found.

    Once asked for it stays, as does what was imported: an edit counts in the next process.

    Parameters
    ----------
    module : str
        Its full name.
    """
    found = sources_of(module).own
    return digest(found).hexdigest()[:16] if found else ""


def digest(sources: Mapping[str, bytes]) -> "hashlib._Hash":
    """Return a hash of some sources by name, to which more may be added."""
    whole = hashlib.sha256()
    for name, source in sorted(sources.items()):
        whole.update(b"%s %d\n" % (name.encode(), len(source)))
        whole.update(source)
    return whole


def signature(package: str, modules: Set[str]) -> list[tuple[str, int, int]]:
    """Return what changes when a package from elsewhere does: files, times and sizes.

    Of an installed package its first file says enough: all are written together. Our own models
    count where they are imported, and what they share always does.

    Parameters
    ----------
    package : str
    modules : set of str
        Those that are imported from elsewhere.
    """
    root = _root(package) if package not in sys.stdlib_module_names else None
    if root is None:
        return []
    folder = root / package
    files = [file for ending in _FILES if (file := Path(f"{folder}{ending}")).is_file()]
    if root.name not in _INSTALLED:
        unused = [root.joinpath(*name.split(".")) for name in own_models() - _above(modules)]
        files += [
            file
            for file in sorted(folder.rglob("*.py"))
            if not any(one in (file.with_suffix(""), *file.parents) for one in unused)
        ]
    looks = ((str(file), file.stat()) for file in files)
    return [(name, look.st_mtime_ns, look.st_size) for name, look in looks]


def is_installed(package: str) -> bool:
    """Return whether a package is not one that somebody may be editing."""
    root = _root(package) if package not in sys.stdlib_module_names else None
    return root is None or root.name in _INSTALLED


@cache
def own_models() -> set[str]:
    """Return the modules of our own models, which see to their compiled code themselves."""
    points = entry_points(group="vibrolife.models")
    names = ((point.dist.name if point.dist else "", point.module) for point in points)
    return {module for name, module in names if name == DISTRIBUTION}


@cache
def own_packages() -> set[str]:
    """Return the packages in which our own models lie."""
    return {module.partition(".")[0] for module in own_models()}


def _above(modules: Iterable[str]) -> set[str]:
    """Return some modules, and the packages in which they lie."""
    parts = (name.split(".") for name in modules)
    return {".".join(names[: i + 1]) for names in parts for i in range(len(names))}


def _root(package: str) -> Path | None:
    """Return the folder in which a package lies, or a module that is a file."""
    try:
        spec = find_spec(package)
    except (ImportError, ValueError):
        return None
    if spec is None:
        return None
    if spec.submodule_search_locations:
        return Path(next(iter(spec.submodule_search_locations))).parent
    return Path(spec.origin).parent if spec.origin else None


def _edited(package: str) -> Path | None:
    """Return the folder of a package that somebody may be editing; None for all others."""
    return None if package in own_packages() or is_installed(package) else _root(package)


def _modules(root: Path, package: str) -> set[str]:
    """Return all modules of a package, or of a module that is a file."""
    files = [file.relative_to(root).with_suffix("") for file in (root / package).rglob("*.py")]
    return {".".join(file.parts).removesuffix(".__init__") for file in files}


def _is_module(root: Path, name: str) -> bool:
    return any(os.path.isfile(f"{root / name}{ending}") for ending in _FILES)


@lru_cache(maxsize=1000)
def _imported(source: bytes, within: str) -> tuple[str, ...]:
    """Return the modules that a source imports anywhere, and names that might be some."""
    try:
        return tuple(_imports(source, within))
    except (ImportError, SyntaxError, ValueError):  # reported by whoever imports it
        return ()


def _imports(source: bytes, within: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and (within or not node.level):
            base = resolve_name("." * node.level + (node.module or ""), within)
            yield from (base, *(f"{base}.{alias.name}" for alias in node.names))
        elif isinstance(node, ast.Call) and _name(node.func) in _IMPORTERS and node.args:
            name = getattr(node.args[0], "value", None)
            yield resolve_name(name, within) if isinstance(name, str) else _COMPUTED


def _name(function: ast.expr) -> str:
    return getattr(function, "attr", getattr(function, "id", ""))
