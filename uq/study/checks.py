"""What a study file asks of its model and of its design, beyond its shape."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from uq.contract import Model
from uq.designs.registry import DESIGNS, IMPORTED
from uq.errors import nearest
from uq.inputs.faults import Fault
from uq.inputs.values import parameter_problem, read_settings, unknown_name
from uq.methods.registry import designs_for, fed_by

Tables = Mapping[str, Mapping[str, Any]]
"""The sound entries of a study file: table -> key -> value, as parsed."""


def model_faults(model: Model, data: Mapping[str, Any], tables: Tables) -> Iterator[Fault]:
    """Yield what does not suit the model, but for the laws of its parameters.

    Parameters
    ----------
    model : Model
    data : dict
        The whole file as parsed: names are checked even where their values are unsound.
    tables : dict
        Its sound entries.

    Yields
    ------
    Fault
    """
    yield from _name_faults(model, data)
    for name, value in tables["fixed"].items():
        if name in model.parameter_names and (problem := parameter_problem(model, name, value)):
            yield Fault(("fixed", name), problem, value)
    given = tables["settings"]
    for name, text in read_settings(model, given)[1].items():
        yield Fault(("settings", name), text, given[name]) if name else Fault(("settings",), text)
    yield from _output_faults(model, tables["analysis"])
    yield from _twin_faults(model, tables["analysis"].get("twin", ""), given)
    if until := tables["design"].get("until"):
        name = until["output"].partition("[")[0]
        if name not in model.outputs:
            problem = unknown_name("output", name, model, tuple(model.outputs))
            yield Fault(("design", "until", "output"), problem, until["output"])
        elif model.outputs[name].is_category:
            yield Fault(("design", "until", "output"), "is a category: it has no numbers", name)


def _name_faults(model: Model, data: Mapping[str, Any]) -> Iterator[Fault]:
    names = {
        table: tuple(data[table]) if isinstance(data.get(table), dict) else ()
        for table in ("fixed", "uncertain")
    }
    for table, given in names.items():
        for name in given:
            if name not in model.parameter_names:
                problem = unknown_name("parameter", name, model, model.parameter_names)
                yield Fault((table, name), problem, data[table][name])
    for name in names["uncertain"]:
        if name in names["fixed"]:
            yield Fault(("uncertain", name), "is in [fixed] too; keep one of the two")
    if isinstance(data.get("uncertain"), dict) and not data["uncertain"]:
        yield Fault(("uncertain",), "nothing varies; give at least one parameter a law")


def _output_faults(model: Model, analysis: Mapping[str, Any]) -> Iterator[Fault]:
    known = tuple(model.outputs)
    for name in analysis.get("outputs", ()):
        if name not in known:
            problem = unknown_name("output", name, model, known)
            yield Fault(("analysis", "outputs"), problem, name)
    for name, value in analysis.get("thresholds", {}).items():
        path = ("analysis", "thresholds", name)
        if name not in known:
            yield Fault(path, unknown_name("output", name, model, known), value)
        elif model.outputs[name].is_category:
            yield Fault(path, "is a category: it has shares, not thresholds", value)


def _twin_faults(model: Model, twin: Any, given: Mapping[str, Any]) -> Iterator[Fault]:
    if isinstance(twin, dict):
        problems = read_settings(model, {**given, **twin})[1]
        for name, text in problems.items():
            if name in twin or not name:
                yield Fault(("analysis", "twin", *filter(None, [name])), text, twin.get(name, twin))
    elif twin and twin not in model.cheap:
        cheap = tuple(model.cheap)
        listed = f" ({', '.join(cheap)})" if cheap else ""
        problem = f"model '{model.name}' cannot compute it alone at a small part of the cost"
        remedy = f"; choose one that it can{listed}" if cheap else "; it has no such output"
        remedy += "; or give a table of settings that make rows cheap" * bool(model.setting_names)
        yield Fault(("analysis", "twin"), f"{problem}{remedy}{nearest(twin, cheap)}", twin)


def design_faults(tables: Tables) -> Iterator[Fault]:
    """Yield what the design cannot serve."""
    table, analysis = tables["design"], tables["analysis"]
    if "method" not in table:
        return
    method = table["method"]
    design = DESIGNS[method]
    if "samples" in table and (problem := design.size_problem(table["samples"])):
        yield Fault(("design", "samples"), f"{problem} for '{method}'", table["samples"])
    if table.get("second_order") and not design.crossed:
        able = _names(name for name, other in DESIGNS.items() if other.crossed)
        yield Fault(("design", "second_order"), f"only for method = {able}", True)
    stated = table.get("independent") and design.imported
    if table.get("independent") and not stated:
        able = _names(IMPORTED)
        yield Fault(("design", "independent"), f"only for method = {able}", True)
    if "tolerance" in analysis and not design.independent and not stated:
        able = _names(name for name, other in DESIGNS.items() if other.independent)
        able += ", independent = true if they are" * (design.imported)
        yield Fault(
            ("analysis", "tolerance"),
            f"refused: its confidence holds for independent rows, and those of '{method}' are not;"
            f" use method = {able}, or leave the bound out",
            analysis["tolerance"],
        )
    if table.get("until") and not design.append_only:
        able = _names(name for name, other in DESIGNS.items() if other.append_only)
        yield Fault(
            ("design", "until"), f"a '{method}' design cannot grow; use method = {able}", True
        )
    elif table.get("until") and not design.independent and table.get("replicates", 1) < 2:
        problem = f"nothing shows how well a '{method}' design knows anything; set replicates = 8"
        yield Fault(("design", "until"), problem, True)
    if analysis.get("twin") and not design.independent:
        able = _names(name for name, other in DESIGNS.items() if other.independent)
        why = (
            "needs rows that can be drawn, and imported rows cannot"
            if stated
            else f"needs independent rows, and those of '{method}' are not"
        )
        yield Fault(("analysis", "twin"), f"{why}; use method = {able}", analysis["twin"])
    unsaid = design.imported and not stated
    dependent = bool(tables["dependence"]) or unsaid
    yield from _method_faults(method, analysis.get("sensitivity", ()), dependent, unsaid)


def _method_faults(
    method: str, asked: Iterable[str], dependent: bool, unsaid: bool
) -> Iterator[Fault]:
    """Yield the sensitivity methods that a design cannot feed."""
    feeds, able = fed_by(DESIGNS[method]), fed_by(DESIGNS[method], dependent)
    if dependent and not able:
        return  # told at the design
    for name in asked:
        if name in feeds and name not in able:
            why = (
                "imported rows may be dependent (independent = true in [design] states that they"
                " are not)"
                if unsaid
                else "[dependence] says they are not"
            )
            yield Fault(
                ("analysis", "sensitivity"),
                f"supposes independent inputs, and {why}; those that do not are {_names(able)}",
                name,
            )
        elif name not in feeds:
            yield Fault(
                ("analysis", "sensitivity"),
                f"a '{method}' design cannot feed it, method = {_names(designs_for(name))} can;"
                f" '{method}' feeds {_names(feeds)}",
                name,
            )


def _names(names: Iterable[str]) -> str:
    return " or ".join(f"'{name}'" for name in names)
