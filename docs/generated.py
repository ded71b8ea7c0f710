"""The tables of the documentation, made from the declarations in the code."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields
from html import escape
from importlib import import_module
from inspect import isclass, isfunction
from math import inf, pi
from pathlib import Path
from types import ModuleType
from typing import Any

import typer
from pydantic import BaseModel
from pydantic_core import PydanticUndefined

from uq.analysis.statistics.table import STATISTICS
from uq.cli.app import app
from uq.contract import Status
from uq.designs.design import Design
from uq.designs.layouts import PLAIN
from uq.designs.registry import DESIGNS
from uq.inputs.registry import LAWS
from uq.methods.registry import METHODS, designs_for, fed_by, for_dependent_inputs
from uq.plots import FIGURES
from uq.study.file import (
    AnalysisTable,
    DependenceTable,
    DesignTable,
    StudyTable,
    Tied,
    Until,
)
from uq.study.reading import read_study_text
from uq.study.registry import find_model, model_names, module_of

STUDY_TABLES = {
    "study": StudyTable,
    "design": DesignTable,
    "until": Until,
    "equals": Tied,
    "dependence": DependenceTable,
    "analysis": AnalysisTable,
}

_GREEK = ("beta", "gamma", "mu", "omega", "phi", "pi", "psi", "rho", "sigma", "xi", "zeta")
_GREEK += tuple(name.capitalize() for name in ("gamma", "omega", "phi", "psi"))
_MULTIPLES = {pi / 6: "π/6", 14 * pi / 180: "14π/180", pi: "π", 2 * pi: "2π"}
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def table(header: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    rows = [header, ["---"] * len(header), *lines]
    return "\n".join(f"| {' | '.join(cell.replace('|', '&#124;') for cell in r)} |" for r in rows)


def formula(symbol: str) -> str:
    r"""Write a symbol of a declaration, such as ``k_tra`` or ``Omega/(2 pi)``, for mathematics.

    >>> print(formula("omega_s1"), formula("m e_1"), formula("X0"))
    $\omega_{\mathrm{s1}}$ $m e_{1}$ $X_{0}$
    """

    def part(found: re.Match[str]) -> str:
        word, digits, below = found.groups()
        word = f"\\{word} " if word in _GREEK else word
        below = digits or below
        if below in _GREEK:
            below = f"\\{below}"
        elif below and re.search("[a-z]{2}|[a-z][0-9A-Z]|[A-Z][a-z]", below):
            below = f"\\mathrm{{{below}}}"
        return f"{word.strip()}_{{{below}}}" if below else word

    return f"${re.sub(r'([A-Za-z]+?)(?:(0)|_([A-Za-z0-9]+))?(?![A-Za-z_0-9])', part, symbol)}$"


def unit(text: str) -> str:
    r"""Write a CF unit with superscripts, in one piece.

    >>> unit("m2 N-1"), unit("1")
    ('m²\xa0N⁻¹', '1')
    """
    if text == "1":
        return text
    raised = re.sub(r"(?<=[A-Za-z])-?\d+", lambda found: found[0].translate(_SUPERSCRIPTS), text)
    return raised.replace(" ", "\u00a0")


def value(number: Any) -> str:
    """Write a number, a word or a list as a study file has it."""
    if isinstance(number, bool):
        return str(number).lower()
    if isinstance(number, float):
        return _MULTIPLES.get(number, f"{number:.6g}")
    if isinstance(number, tuple):
        return f"[{', '.join(value(one) for one in number)}]"
    return f'"{number}"' if isinstance(number, str) else str(number)


def interval(ends: tuple[float, float] | None) -> str:
    """Write what is admissible."""
    if ends is None:
        return ""
    low, high = ends
    return f"from {_end(low)}" if high == inf else f"{_end(low)} to {_end(high)}"


def _end(end: float) -> str:
    if abs(end) in _MULTIPLES:
        return f"{'−' if end < 0 else ''}{_MULTIPLES[abs(end)]}"
    text = f"{end:.0f}" if 1e3 <= abs(end) < 1e6 else f"{end:.4g}"
    return _minus(text)


def _minus(text: str) -> str:
    return text.replace("-", "−", 1) if text.startswith("-") else text


def machines() -> list[str]:
    """Return the names of the models that are no functions with known answers."""
    return [name for name in model_names() if module_of(name) != "models.analytic"]


def parameters(name: str) -> str:
    """Tabulate the parameters of a model."""
    model = find_model(name)
    lines = []
    for parameter, nominal in model.nominal.items():
        one = model.parameter(parameter)
        stated = value(nominal) + ("" if one.unit == "1" else f"\u00a0{unit(one.unit)}")
        lines.append(
            (
                formula(one.symbol),
                f"`{parameter}`<br>{one.meaning}",
                _minus(stated),
                interval(one.bounds),
                one.source,
            )
        )
    return table(("symbol", "parameter", "nominal", "admissible", "source"), lines)


def settings(name: str) -> str:
    """Tabulate the numerical settings of a model."""
    model = find_model(name)
    lines = []
    for field in fields(model.settings):
        one = model.setting(field.name)
        allowed = ", ".join(f'`"{word}"`' for word in one.choices) or interval(one.bounds)
        default = f"`{value(field.default)}`"
        if one.unit != "1":
            default += f"\u00a0{unit(one.unit)}"
        lines.append((f"`{field.name}`", default, allowed, one.meaning))
    return table(("setting", "default", "allowed", "meaning"), lines)


def outputs(name: str) -> str:
    """Tabulate the outputs of a model."""
    lines = []
    for output, one in find_model(name).outputs.items():
        meaning = one.meaning + "".join(f"<br>`{word}`" for word in one.categories)
        more = [] if one.kind == "value" else [one.kind]
        more += ["may be undefined"] if one.may_be_undefined else []
        late = one.has_censored_flag and not one.never_known_at_once
        more += ["may never end if censored"] if late else []
        more += ["never censored"] if one.is_lifetime and not one.may_be_censored else []
        dims = f" ({', '.join(one.dims)})" if one.dims else ""
        lines.append((f"`{output}`{dims}", unit(one.unit), meaning, ", ".join(more)))
    return table(("output", "unit", "meaning", ""), lines)


def page(name: str) -> str:
    """Return the name of a page, if there is one, for a table of contents."""
    return name if (Path(__file__).parent / f"{name}.md").is_file() else ""


def output(name: str) -> str:
    """Quote what a command printed, kept in a file beside this one."""
    text = (Path(__file__).parent / "outputs" / f"{name}.txt").read_text(encoding="utf-8")
    return f"```text\n{text}```"


def studies(name: str) -> str:
    """Tabulate the studies of a model that come with the project."""
    lines = []
    for path in sorted((Path(__file__).parents[1] / "studies").glob("*.toml")):
        study = read_study_text(path.read_text(encoding="utf-8"), str(path))
        if study.study.model == name:
            rows = f"{study.design.method}, {study.design.samples} samples"
            lines.append((f"`studies/{path.name}`", study.study.description, rows))
    return table(("study", "", "design"), lines)


def references(name: str) -> str:
    """List what to cite for a model."""
    return "\n".join(f"- {text}" for text in find_model(name).references)


def nomenclature() -> str:
    """Tabulate every parameter of every model, by name."""
    lines = [
        (f"`{name}`", formula(one.symbol), unit(one.unit), one.meaning, machine)
        for machine in model_names()
        for name in find_model(machine).nominal
        for one in [find_model(machine).parameter(name)]
    ]
    return table(("name", "symbol", "unit", "meaning", "model"), sorted(lines))


def all_outputs() -> str:
    """Tabulate every output of every model, by name."""
    lines = [
        (f"`{name}`", unit(one.unit), one.meaning, machine)
        for machine in model_names()
        for name, one in find_model(machine).outputs.items()
    ]
    return table(("name", "unit", "meaning", "model"), sorted(lines))


def regimes() -> str:
    """Tabulate the regimes of the machines."""
    lines = [
        (
            machine,
            ", ".join(f"`{word}`" for word in find_model(machine).outputs["regime"].categories),
        )
        for machine in machines()
        if "regime" in find_model(machine).outputs
    ]
    return table(("machine", "regimes"), lines)


def statuses() -> str:
    """Tabulate how a row can end."""
    return table(("status", "meaning"), [(f"`{one.label}`", one.meaning) for one in Status])


def keys(name: str) -> str:
    """Tabulate the keys of one table of a study file."""
    lines = []
    for key, field in STUDY_TABLES[name].model_fields.items():
        default = "required" if field.is_required() else _default(field.get_default())
        lines.append((f"`{key}`", default, field.description or ""))
    return table(("key", "default", "meaning"), lines)


def _default(found: Any) -> str:
    if found is None or found is PydanticUndefined or found == "" or found == () or found == {}:
        return ""
    return f"`{value(found)}`"


def laws() -> str:
    """Tabulate the laws an uncertain parameter can follow."""
    lines = []
    for name, law in LAWS.items():
        arguments = ", ".join(f"`{one}`" for one in _own(law))
        lines.append((f'`"{name}"`', arguments, (law.__doc__ or "").splitlines()[0]))
    return table(("`distribution`", "arguments", "law"), lines)


def _own(law: type[BaseModel]) -> list[str]:
    common = ("distribution", "source", "truncate", "times")
    return [name for name in law.model_fields if name not in common]


def designs() -> str:
    """Tabulate the designs."""
    lines = []
    for name, design in DESIGNS.items():
        feeds = ", ".join(
            method if METHODS[method].assumes_independence else f"{method}\\*"
            for method in fed_by(design)
        )
        can = "yes" if design.append_only else "no"
        lines.append((f'`"{name}"`', design.meaning, can, feeds))
    return table(("`method`", "rows", "extend", "sensitivity methods, the default first"), lines)


def confidence() -> str:
    """Tabulate the basis of the intervals of statistics and indices, by design."""
    lines = []
    for name, design in DESIGNS.items():
        indices = {METHODS[method].intervals for method in fed_by(design)} - {""}
        lines.append((f"`{name}`", _of_statistics(design), "; ".join(indices) or "none"))
    return table(("design", "intervals of statistics", "of sensitivity indices"), lines)


def _of_statistics(design: Design) -> str:
    if design.independent:
        return "formulas for independent rows"
    if design.imported:
        return "none: the origin of its rows is unknown; formulas if stated to be independent"
    if not design.follows_laws:
        return "no statistics: its rows do not follow the laws of the inputs"
    return "the scatter between replicates; none from a single replicate, and the summary says so"


def methods() -> str:
    """Tabulate the sensitivity methods: what they give, and how."""
    lines = []
    for name, method in METHODS.items():
        gives = method.gives or ", ".join(kind.words for kind in method.kinds)
        null = "; compared with a null" if method.has_null else ""
        most = "" if method.most_rows is None else f"{method.most_rows:,}"
        how = method.intervals or f"none{null}"
        lines.append((f"`{name}`", gives.replace("*", "\\*"), method.source, how, most))
    return table(("method", "index", "estimator", "interval", "rows at most"), lines)


def questions() -> str:
    """Tabulate what each sensitivity method answers, and what it needs."""
    lines = []
    for name, method in METHODS.items():
        able = " or ".join(f"`{design}`" for design in designs_for(name))
        needs = "a plain sample" if method.layout is PLAIN else f"design {able}"
        lines.append((method.question, f"`{name}`", needs))
    plain = [f"`{name}`" for name, one in DESIGNS.items() if one.layout is PLAIN]
    dependent = [f"`{name}`" for name in for_dependent_inputs()]
    return table(("question", "method", "needs"), lines) + (
        f"\n\nPlain samples come from the designs {', '.join(plain)}. {', '.join(dependent)} also"
        " accept dependent inputs, and imported rows that are not stated to be independent."
    )


def statistics() -> str:
    """Tabulate what a summary may say of an output."""
    lines = [(f"`{name}`", _first_line(make, "Yield")) for name, make in STATISTICS.items()]
    return table(("statistics", ""), lines)


def figures() -> str:
    """Tabulate the figures of a result."""
    lines = [
        (f"`{name}`", _first_line(entry.of, "Yield"), _first_line(entry.draw, "Draw"))
        for name, entry in FIGURES.items()
    ]
    return table(("figure", "of", "shows"), lines)


def _first_line(function: Any, verb: str) -> str:
    """Return the first line of a docstring without its verb and full stop."""
    return (function.__doc__ or "").splitlines()[0].removeprefix(f"{verb} ").removesuffix(".")


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
    return f"## uq {name}\n\n`uq {name} {usage}`".replace(" `", "`") + f": {command.help}{options}"


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
    lines += [f".. autoexception:: {name}.{one}" for one, f in offered.items() if isclass(f)]
    return "\n".join(["```{eval-rst}", *lines, "```"])


def _is_own(found: Any, module: ModuleType) -> bool:
    if not isfunction(found) or found.__name__.startswith("_"):
        return False
    return found.__module__ == module.__name__ or found.__module__.endswith("_plot")
