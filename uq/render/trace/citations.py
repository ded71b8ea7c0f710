"""Summary and references of an estimator, from its docstring."""

import inspect
import re
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from uq.indices.methods import METHODS, indices_of


class Citation(NamedTuple):
    """Citation of an estimator.

    Attributes
    ----------
    does : str
        One-line summary.
    code : str
        Function that computes it: ``uq.stats.order_statistics.quantile``.
    sources : tuple of str
        References of its docstring.
    """

    does: str
    code: str = ""
    sources: tuple[str, ...] = ()


def cited(function: Callable[..., Any]) -> Citation:
    """Return the summary and references in the docstring of an estimator or of its method."""
    if isinstance(function, partial) and function.func is indices_of:
        return _of_index(*function.args)
    while isinstance(function, partial):
        function = function.func
    docstring = inspect.getdoc(function) or ""
    first = _joined(docstring.split("\n\n")[0])
    section = re.search(
        r"^References\n-+\n(.*?)(?=^\w+\n-+$|\Z)", docstring, re.DOTALL | re.MULTILINE
    )
    entries = re.split(r"^\.\. (?=\[\d+\] )", section[1], flags=re.MULTILINE) if section else []
    code = f"{function.__module__}.{getattr(function, '__qualname__', '')}"
    return Citation(first.removesuffix("."), code, tuple(filter(None, map(_joined, entries))))


def _of_index(method: str, key: str) -> Citation:
    """Return question, estimator and references of a method; with key "", of no kind of index."""
    estimator = METHODS[method]
    kinds = [f" ({kind.words})" for kind in estimator.kinds if kind.key == key]
    code = f"uq.indices.methods.METHODS['{method}']"
    references = [estimator.source, estimator.intervals and f"intervals: {estimator.intervals}"]
    sources = (*filter(None, references), *cited(estimator.estimate).sources)
    return Citation(f"{estimator.question}{''.join(kinds)}", code, sources)


def _joined(text: str) -> str:
    """Return text on one line, with ``[1]`` for the mark ``[1]_``."""
    return re.sub(r"(\[\d+\])_", r"\1", " ".join(text.split()))
