"""The tables of what a study asks and of what is shown of its result, made from the registries."""

from typing import Any

from pydantic import BaseModel
from pydantic_core import PydanticUndefined

from uq.assess.statistics.table import STATISTICS
from uq.indices.methods import METHODS, designs_for, fed_by, for_dependent_inputs
from uq.plots import FIGURES
from uq.sampling.designs import DESIGNS, PLAIN, Design
from uq.sampling.laws import LAWS
from uq.sampling.scipy_laws import PAIRS
from uq.study.file import AnalysisTable, DependenceTable, DesignTable, StudyTable, Tied, Until

from .markdown import table, value

STUDY_TABLES = {
    "study": StudyTable,
    "design": DesignTable,
    "until": Until,
    "equals": Tied,
    "dependence": DependenceTable,
    "analysis": AnalysisTable,
}


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
    common = ("distribution", "source", "truncate", "times", "level")
    return [name for name in law.model_fields if name not in common]


def wear_coefficients() -> str:
    """Tabulate the published wear coefficients of the law that is named after them."""
    lines = [(f'`"{pair}"`', f"{coefficient:.3g}") for pair, coefficient in PAIRS.items()]
    return table(("`pair`: worn body/counter-body", "coefficient [m²/N]"), lines)


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
    together = [f"`{name}`" for name, method in METHODS.items() if method.aggregates]
    return table(("method", "index", "estimator", "interval", "rows at most"), lines) + (
        f"\n\n{', '.join(together)} also give one index of all elements of an output together."
    )


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
        (f"`{name}`", _first_line(entry.subjects, "Yield"), _first_line(entry.draw, "Draw"))
        for name, entry in FIGURES.items()
    ]
    return table(("figure", "of", "shows"), lines)


def _first_line(function: Any, verb: str) -> str:
    """Return the first line of a docstring without its verb and full stop."""
    return (function.__doc__ or "").splitlines()[0].removeprefix(f"{verb} ").removesuffix(".")
