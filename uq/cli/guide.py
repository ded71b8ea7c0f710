"""Output of ``uq`` without a command: next steps."""

import shlex
import tomllib
from contextlib import suppress
from math import inf
from pathlib import Path

from uq.cli.printing import console, grid, heading, paragraph

_STEPS = (
    ("uq models", "list the models"),
    ("uq init beam > mine.toml", "write a commented study to edit"),
    ("uq check mine.toml", "check it, and show what would run"),
    ("uq run mine.toml", "compute it, into results/NAME.nc"),
    ("uq report results/NAME.nc --open", "show everything on one page, in the browser"),
)

_MINUTE = 60.0  # [s]


def guide() -> None:
    """Print the steps to a report, and possible commands for the files in this folder."""
    heading("uq", "lifetime and sensitivity studies of vibro-impact machines")
    grid(_STEPS)
    if here := _with_what_is_here():
        heading("\nIn this folder")
        for command, words in here:
            console.print(f"  {command}", soft_wrap=True)
            paragraph(words, indent=6)
    console.print("\nuq --help lists all commands; uq COMMAND --help explains one.")


def _with_what_is_here() -> list[tuple[str, str]]:
    lines = []
    for folder, ending, verb, words in (
        ("studies", "toml", "run {}", "run this study"),
        ("results", "nc", "report {} --open", "read this result"),
    ):
        files = sorted(Path(folder).glob(f"*.{ending}"), key=_latest_and_shortest)
        if files:
            others = f"one of {len(files) - 1} others" if files[2:] else "1 other"
            more = f", or {others} in {folder}/" if files[1:] else ""
            name = shlex.quote(str(files[0]))
            model = _model_option(files[0]) if ending == "toml" else ""
            lines.append((f"uq {verb.format(name)}{model}", words + more))
    return lines


def _latest_and_shortest(file: Path) -> tuple[float, int, str]:
    """Return the key that puts the last edited file first, the shortest of a fresh checkout."""
    try:
        status = file.stat()
    except OSError:
        return inf, 0, file.name
    return -(status.st_mtime // _MINUTE), status.st_size, file.name


def _model_option(study: Path) -> str:
    """Return ``--model`` and a file, after a blank, for a study of a model in a file here."""
    from uq.study.installed_models import model_names
    from uq.study.model_files import file_with

    with suppress(OSError, ValueError, KeyError, TypeError, RecursionError):
        model = tomllib.loads(study.read_text("utf-8-sig"))["study"]["model"]
        if model not in model_names() and (file := file_with(model, (Path(), study.parent))):
            return f" --model {file}"
    return ""
