"""Words with which a shell completes an argument or the value of an option."""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from uq.result.result import Result


def complete_model(incomplete: str) -> list[str]:
    """Return the names of installed models."""
    from uq.study.installed_models import model_names

    return _starting(incomplete, model_names())


def complete_design(incomplete: str) -> list[str]:
    """Return the designs of studies."""
    from uq.sampling.designs import DESIGNS

    return _starting(incomplete, DESIGNS)


def complete_method(incomplete: str) -> list[str]:
    """Return the methods of sensitivity analysis."""
    from uq.indices.methods import METHODS

    return _starting(incomplete, METHODS)


def complete_figure(incomplete: str) -> list[str]:
    """Return the kinds of figures."""
    from uq.plots import FIGURES, TABLES

    return _starting(incomplete, FIGURES | TABLES)


def complete_study(incomplete: str) -> list[str]:
    """Return study files, here and one folder deeper."""
    return list(_files(incomplete, ".toml"))


def complete_result(incomplete: str) -> list[str]:
    """Return results, here and one folder deeper."""
    return list(_files(incomplete, ".nc"))


def complete_study_or_result(incomplete: str) -> list[str]:
    """Return study files and results, here and one folder deeper."""
    return complete_study(incomplete) + complete_result(incomplete)


def complete_format(incomplete: str) -> list[str]:
    """Return the formats of figures."""
    from uq.render.figures.figure import FORMATS

    return _starting(incomplete, FORMATS)


def complete_change(context: typer.Context, incomplete: str) -> list[str]:
    """Return the entries of the laws of the result that the line names before."""
    from uq.assess.what_if import changeable
    from uq.text.literals import read_toml

    entries: Iterable[str] = ()
    with suppress(Exception):
        study = read_toml(_opened(context).dataset.attrs["study"])
        entries = [f"uncertain.{entry}=" for entry in changeable(study["uncertain"])]
    return _starting(incomplete, entries)


def complete_key(context: typer.Context, incomplete: str) -> list[str]:
    """Return the keys of numbers of the result that the line names before."""
    from uq.render.trace.trace import keys_of

    keys: Iterable[str] = ()
    with suppress(Exception):
        keys = keys_of(_opened(context), incomplete)
    return _starting(incomplete, keys)


def complete_output(context: typer.Context, incomplete: str) -> list[str]:
    """Return the outputs of the result or the study that the line names before."""
    file = _file_in(context)
    names: Iterable[str] = ()
    with suppress(Exception):  # a shell has no room for the fault of a file
        if file.endswith(".nc"):
            names = _opened(context).outputs
        elif file:
            from uq.execution.loading import load_study

            names = load_study(file).model.outputs
    return _starting(incomplete, names)


def _file_in(context: typer.Context) -> str:
    """Return the first argument, which is parsed only where another argument is completed."""
    return next(iter(context.args), "") or str(context.params.get("result") or "")


def _opened(context: typer.Context) -> "Result":
    from uq.result.result import Result

    return Result.open(_file_in(context))


def _starting(incomplete: str, words: Iterable[str]) -> list[str]:
    return [word for word in words if word.startswith(incomplete)]


def _files(incomplete: str, ending: str) -> Iterator[str]:
    typed = Path(incomplete)
    folder = typed if incomplete.endswith("/") or not incomplete else typed.parent
    start = incomplete.removeprefix("./")
    with suppress(OSError):
        for path in sorted(chain(folder.glob(f"*{ending}"), folder.glob(f"*/*{ending}"))):
            if str(path).startswith(start) and not any(part[0] == "." for part in path.parts):
                yield incomplete[: len(incomplete) - len(start)] + str(path)
