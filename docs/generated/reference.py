"""The reference of the command line and of Python, and what commands print."""

from collections.abc import Iterator
from html import escape
from importlib import import_module
from inspect import isclass, isfunction
from pathlib import Path
from types import ModuleType
from typing import Any

import typer

from uq.cli.app import app

from .markdown import table

DOCS = Path(__file__).parents[1]


def page(name: str) -> str:
    """Return the name of a page, if there is one, for a table of contents."""
    return name if (DOCS / f"{name}.md").is_file() else ""


def output(name: str) -> str:
    """Quote what a command printed, kept in a file beside the pages."""
    text = (DOCS / "outputs" / f"{name}.txt").read_text(encoding="utf-8")
    return f"```text\n{text}```"


def verbs() -> str:
    """Describe every verb of the command line."""
    return "\n\n".join(_verb(name, command) for name, command in commands().items())


def commands() -> dict[str, Any]:
    """Return the verbs of ``uq`` by name."""
    return dict(typer.main.get_command(app).commands)  # type: ignore[attr-defined]


def _verb(name: str, command: Any) -> str:
    arguments = [one for one in command.params if one.param_type_name == "argument"]
    usage = " ".join(_metavar(one) for one in arguments)
    lines = [
        (", ".join(f"`{text}`" for text in _spellings(one)), escape(one.help or ""))
        for one in command.params
        if one.param_type_name == "option"
    ]
    options = "\n\n" + table(("option", ""), lines) if lines else ""
    usage = f"`uq {name} {usage}`".replace(" `", "`")
    example = command.epilog.partition("Example:\n")[2].strip()
    return f"## uq {name}\n\n{usage}: {command.help}\n\n```sh\n{example}\n```{options}"


def _metavar(argument: Any) -> str:
    name = argument.metavar or argument.name.upper()
    return name if argument.required else f"[{name}]"


def _spellings(option: Any) -> Iterator[str]:
    for spelling in option.opts:
        yield f"{spelling} {option.metavar}" if option.metavar else spelling


def functions(name: str) -> str:
    """Return the directives that document what a module offers, each from its docstring."""
    name = name.replace("-", ".")
    module = import_module(name)
    public = getattr(module, "__all__", None) or [
        one for one, found in vars(module).items() if _is_own(found, module)
    ]
    offered = {one: getattr(module, one) for one in public}
    lines = [f".. autofunction:: {name}.{one}" for one, f in offered.items() if isfunction(f)]
    for one, member in offered.items():
        if isclass(member):
            kind = "exception" if issubclass(member, Exception) else "class"
            lines += [f".. auto{kind}:: {name}.{one}", "   :members:"]
    return "\n".join(["```{eval-rst}", *lines, "```"])


def _is_own(found: Any, module: ModuleType) -> bool:
    if not isfunction(found) or found.__name__.startswith("_"):
        return False
    return found.__module__ == module.__name__ or found.__module__.endswith(("_plot", "_plots"))
