"""Source files of a model's module, and of the modules that it imports.

These are the files of its package, and of imported packages that are not installed, in any folder.
Installed packages are identified by their version. The platform itself is not part of a model.
"""

import ast
import hashlib
import os
import sys
from codecs import BOM_UTF8
from collections.abc import Iterable, Iterator, Mapping, Set
from functools import cache, lru_cache
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.metadata import entry_points
from importlib.util import find_spec, resolve_name
from pathlib import Path

DISTRIBUTION = "vibrolife"
INSTALLED = ("site-packages", "dist-packages")
_PLATFORM = __name__.partition(".")[0]
_COMPUTED = "*"  # a module whose name is computed at run time
_IMPORTERS = ("import_module", "__import__")
_FILES = ("/__init__.py", ".py", *EXTENSION_SUFFIXES)


def sources_of(module: str) -> tuple[dict[str, bytes], set[str]]:
    """Return the sources of a module and, recursively, of the modules that it imports.

    Parameters
    ----------
    module : str
        Full name; the module need not be imported.

    Returns
    -------
    code : dict of str to bytes
        Module -> source, or machine code of an extension; empty if no file exists.
    others : set of str
        Modules imported from other packages.
    """
    package = module.partition(".")[0]
    root = _root(package)
    code: dict[str, bytes] = {}
    others: set[str] = set()
    if root is None:
        return code, others
    beside = root.name not in INSTALLED
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
            if name not in code and file.is_file():
                code[name] = _without_marks(file)
                above = name.rpartition(".")[0]
                within = name if ending == _FILES[0] else above
                inside = set(_imported(code[name], within)) if ending.endswith(".py") else set()
                if _COMPUTED in inside:
                    inside |= _modules(home, first)
                todo |= {above or name, *inside} - seen
        todo = {name for name in todo if name.partition(".")[0] != _PLATFORM}
    return code, others


def _without_marks(file: Path) -> bytes:
    """Return a source without byte-order mark and carriage returns, which editors may insert."""
    content = file.read_bytes()
    if file.suffix != ".py":
        return content
    return content.removeprefix(BOM_UTF8).replace(b"\r\n", b"\n")


@cache
def fingerprint(module: str) -> str:
    """Return a hash of the sources of a module, see `sources_of`; "" if it has no source file.

    It is computed once per process, like the import: an edit counts in the next process.

    Parameters
    ----------
    module : str
        Full name of the module.
    """
    code, _ = sources_of(module)
    return digest(code).hexdigest()[:16] if code else ""


def digest(sources: Mapping[str, bytes]) -> "hashlib._Hash":
    """Return an extensible hash object of named sources."""
    whole = hashlib.sha256()
    for name, source in sorted(sources.items()):
        whole.update(b"%s %d\n" % (name.encode(), len(source)))
        whole.update(source)
    return whole


def signature(package: str, modules: Set[str]) -> list[tuple[str, int, int]]:
    """Return the files of another package with their modification times and sizes.

    For an installed package the first file is sufficient, since all files are written together. Our
    own models are included only if they are imported; their shared modules are always included.

    Parameters
    ----------
    package : str
    modules : set of str
        Modules imported from other packages.
    """
    root = _root(package) if package not in sys.stdlib_module_names else None
    if root is None:
        return []
    folder = root / package
    files = [file for ending in _FILES if (file := Path(f"{folder}{ending}")).is_file()]
    if root.name not in INSTALLED:
        unused = [root.joinpath(*name.split(".")) for name in own_models() - _above(modules)]
        files += [
            file
            for file in sorted(folder.rglob("*.py"))
            if not any(path in (file.with_suffix(""), *file.parents) for path in unused)
        ]
    statuses = ((str(file), file.stat()) for file in files)
    return [(name, status.st_mtime_ns, status.st_size) for name, status in statuses]


def is_installed(package: str) -> bool:
    """Return whether a package is installed, and therefore not edited."""
    root = _root(package) if package not in sys.stdlib_module_names else None
    return root is None or root.name in INSTALLED


@cache
def own_models() -> set[str]:
    """Return the modules of our own models, which manage their own compiled code."""
    points = entry_points(group="vibrolife.models")
    names = ((point.dist.name if point.dist else "", point.module) for point in points)
    return {module for name, module in names if name == DISTRIBUTION}


@cache
def own_packages() -> set[str]:
    """Return the packages of our own models."""
    return {module.partition(".")[0] for module in own_models()}


def _above(modules: Iterable[str]) -> set[str]:
    """Return modules and the packages that contain them."""
    parts = (name.split(".") for name in modules)
    return {".".join(names[: i + 1]) for names in parts for i in range(len(names))}


def found_at(package: str) -> Path | None:
    """Return the file or folder from which Python imports a package; None if there is none."""
    try:
        spec = find_spec(package)
    except (ImportError, ValueError):  # ValueError: imported, but without a location
        return None
    places = [*(spec.submodule_search_locations or []), spec.origin] if spec else []
    return Path(places[0]) if places and places[0] else None


def _root(package: str) -> Path | None:
    """Return the folder that contains a package, or a module that is a file."""
    place = found_at(package)
    return place and place.parent


def _edited(package: str) -> Path | None:
    """Return the folder of a package that may be edited; None for all others."""
    return None if package in own_packages() or is_installed(package) else _root(package)


def _modules(root: Path, package: str) -> set[str]:
    """Return all modules of a package, or of a module that is a file."""
    files = [file.relative_to(root).with_suffix("") for file in (root / package).rglob("*.py")]
    return {".".join(file.parts).removesuffix(".__init__") for file in files}


def _is_module(root: Path, name: str) -> bool:
    return any(os.path.isfile(f"{root / name}{ending}") for ending in _FILES)


@lru_cache(maxsize=1000)
def _imported(source: bytes, within: str) -> tuple[str, ...]:
    """Return the modules imported anywhere in a source, and names that may be modules."""
    try:
        return tuple(_imports(source, within))
    except (ImportError, SyntaxError, ValueError):  # reported when the module is imported
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
