"""The code of a model, as one number: what two codes have computed is no one result.

A model's version is its author's promise; this is what the files say.
"""

import ast
import hashlib
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.util import find_spec, resolve_name
from pathlib import Path

from uq.provenance import provenance
from uq.study.registry import module_of


def made_here(reference: str) -> dict[str, str]:
    """Return what makes the rows of a model here: processor, versions and the model's code.

    Parameters
    ----------
    reference : str
        What `uq.study.registry.find_model` finds the model by.
    """
    return provenance() | {"code": code_of(reference)}


def is_other_code(made: Mapping[str, object], reference: str) -> bool:
    """Return whether rows were made by other code than is here.

    Parameters
    ----------
    made : dict
        What made them, as `made_here` told then; without ``code``, nothing is known.
    reference : str
        As above.
    """
    here = code_of(reference)
    return made.get("code", here) != here


@cache
def code_of(reference: str) -> str:
    """Return a hash of the sources of a model: its module, and what that imports of its package.

    Parameters
    ----------
    reference : str
        What `uq.study.registry.find_model` finds the model by.

    Returns
    -------
    str
        The same wherever the package lies. Once asked for it stays, as does what was imported.
    """
    module = module_of(reference)
    package = module.partition(".")[0]
    root = _folder(package)
    sources: dict[str, bytes] = {}
    todo = {module}
    while todo:
        name = todo.pop()
        place = root.joinpath(*name.split("."))
        for file in (place / "__init__.py", place.with_suffix(".py")):
            if name not in sources and file.is_file():
                sources[name] = file.read_bytes()
                above = name.rpartition(".")[0]
                within = name if file.stem == "__init__" else above
                todo |= {above or package, *_imported(sources[name], within)}
        todo = {name for name in todo - set(sources) if name.partition(".")[0] == package}
    whole = hashlib.sha256()
    for name, source in sorted(sources.items()):
        whole.update(b"%s %d\n" % (name.encode(), len(source)))
        whole.update(source)
    return whole.hexdigest()[:16]


def _folder(package: str) -> Path:
    """Return the folder in which a package, or a module that is a file, lies."""
    spec = find_spec(package)
    if spec is None or spec.origin is None:
        return Path(package)
    return Path(spec.origin).parents[1 if spec.submodule_search_locations else 0]


def _imported(source: bytes, within: str) -> Iterator[str]:
    """Yield the modules that a source imports anywhere, and names that might be some."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and (within or not node.level):
            base = resolve_name("." * node.level + (node.module or ""), within)
            yield from (base, *(f"{base}.{alias.name}" for alias in node.names))
