"""Semantic validation of a study file against its model and its design."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from math import pi
from typing import Any

from uq.contract import Model
from uq.errors import choices, nearest
from uq.indices.methods import designs_for, fed_by, kinds_with_intervals
from uq.machines.row_by_row import RowByRow
from uq.sampling.designs import DESIGNS, PATHS, Design
from uq.sampling.input_faults import InputFault, unknown
from uq.sampling.levels import MAX_ROWS_OF_A_SAMPLE, OWN, dimension
from uq.sampling.named_values import parameter_problem, read_settings, setting_types, unknown_name
from uq.text.element_names import place_of, places, whole_name
from uq.text.quantities import misfit, read_quantity

Tables = Mapping[str, Mapping[str, Any]]
"""Valid entries of a study file: table -> key -> value, as parsed."""


def model_faults(model: Model, data: Mapping[str, Any], tables: Tables) -> Iterator[InputFault]:
    """Yield the faults of a study with this model, except faults in the laws of its parameters.

    Parameters
    ----------
    model : Model
    data : dict
        Complete file as parsed: names are checked even if their values are invalid.
    tables : dict
        Valid entries of the file.

    Yields
    ------
    InputFault
    """
    yield from _name_faults(model, data)
    for name, value in tables["fixed"].items():
        number = number_of_fixed(value)
        if name in model.parameter_names and (problem := parameter_problem(model, name, number)):
            yield InputFault(("fixed", name), problem, number)
    given, analysis = tables["settings"], tables["analysis"]
    settings, problems = read_settings(model, given)
    for name, text in problems.items():
        value = given.get(name)
        if isinstance(value, dict) or str(value).endswith(".csv"):
            text += '; or {file = "NAME.csv", columns = ["A", "B"]}'
        yield (
            InputFault(("settings", name), text, value) if name else InputFault(("settings",), text)
        )
    output_faults = partial(_output_faults, model, settings)
    for name in analysis.get("outputs", ()):
        yield from output_faults(name, ("analysis", "outputs"), name)
    for key, nouns in _OF_NUMBERS.items():
        for name, value in analysis.get(key, {}).items():
            path = ("analysis", key, name)
            faults = list(output_faults(name, path, value, f"it has shares, not {nouns}"))
            yield from faults
            if faults:
                continue
            if key == "thresholds":
                for threshold in value if isinstance(value, list) else [value]:
                    yield from _unit_faults(model, name, path, threshold)
            elif key == "wanted" and model.outputs and model.outputs[name].is_lifetime:
                problem = "is a lifetime, whose model states if its end is wanted; leave it out"
                yield InputFault(path, problem, value)
    yield from _twin_faults(model, analysis.get("twin", ""), given)
    if until := tables["design"].get("until"):
        name = until["output"].partition("[")[0]
        path = ("design", "until", "output")
        faults = list(output_faults(name, path, until["output"], "it has no numbers"))
        yield from faults
        if not faults and model.outputs:
            yield from _until_faults(model, name, until)
            yield from _element_faults(model, name, until, settings)


_OF_NUMBERS = {"thresholds": "thresholds", "joint_bounds": "bounds", "wanted": "sides"}
"""Keys of [analysis] for numeric outputs -> the nouns of their values."""


def _until_faults(model: Model, name: str, until: Mapping[str, Any]) -> Iterator[InputFault]:
    """Yield the faults of the stopping rule `until` that concern its output."""
    path = ("design", "until")
    for key in ("above", "below"):
        yield from _unit_faults(model, name, (*path, key), until.get(key))
    if "b_life" in until and not model.outputs[name].is_lifetime:
        lives = [life for life, output in model.outputs.items() if output.is_lifetime]
        problem = f"'{name}' is not a lifetime (lifetimes: {choices(lives)})"
        yield InputFault((*path, "b_life"), problem, until["b_life"])
    half_width = until["half_width"]
    pure = next((key for key in ("above", "below", "index") if key in until), "")
    if not pure:
        yield from _unit_faults(model, name, (*path, "half_width"), half_width)
    elif isinstance(half_width, str) and (problem := misfit(half_width, pure, "1")):
        yield InputFault((*path, "half_width"), problem, half_width)


def _element_faults(
    model: Model, name: str, until: Mapping[str, Any], settings: Any
) -> Iterator[InputFault]:
    """Yield a fault if the named element of an output does not exist with these settings."""
    element = until["output"]
    if element == name or settings is None:
        return
    coordinates = model.coordinates(settings)
    axes = {dim: coordinates[dim] for dim in model.outputs[name].dims}
    names = [label for label, *_ in places(name, axes)]
    if element == whole_name(name) and len(names) > 1:
        if "index" not in until:
            problem = f"all elements together have only an index; '{name}' is each of them"
            yield InputFault(("design", "until", "output"), problem, element)
    elif not place_of(element, axes):
        problem = f"no such element{nearest(element, names)} (allowed: {choices(names)})"
        yield InputFault(("design", "until", "output"), problem, element)


def number_of_fixed(entry: Any) -> Any:
    """Return the number of an entry in [fixed], which may be a table with its source."""
    return entry.get("value") if isinstance(entry, Mapping) else entry


def _name_faults(model: Model, data: Mapping[str, Any]) -> Iterator[InputFault]:
    fixed, uncertain = (
        data[table] if isinstance(data.get(table), dict) else {} for table in ("fixed", "uncertain")
    )
    for table, given in (("fixed", fixed), ("uncertain", uncertain)):
        for name, value in given.items():
            if name not in model.parameter_names:
                problem = unknown_name("parameter", name, model, model.parameter_names)
                yield InputFault((table, name), problem, value)
    for name in uncertain:
        if name in fixed:
            yield InputFault(("uncertain", name), "is in [fixed] too; keep one of the two")
    if data.get("uncertain") == {}:
        yield InputFault(("uncertain",), "nothing varies; give at least one parameter a law")


def _output_faults(
    model: Model,
    settings: Any,
    name: str,
    path: tuple[str, ...],
    value: Any,
    no_number: str = "",
) -> Iterator[InputFault]:
    """Yield a fault if an output does not exist, or is a category although a number is required."""
    if not model.outputs:  # undeclared before rows have run
        return
    whole = re.split(r"\[|\s", name.strip())[0]  # "life[depth=1e-4]", "life at 100 um"
    if name != whole and whole in model.outputs:
        axes = {
            dim: key
            for dim in model.outputs[whole].dims
            for key in (dim, f"{dim}s")
            if key in model.setting_names
        }
        place = "".join(f"; for one {dim} alone, give no other in '{axes[dim]}'" for dim in axes)
        yield InputFault(path, f"name the output without its element: '{whole}'{place}", value)
    elif name not in model.outputs:
        yield InputFault(path, unknown_name("output", name, model, tuple(model.outputs)), value)
    elif settings is not None and name not in model.given(settings).outputs:
        types = setting_types(model)
        lists = [setting for setting, kind in types.items() if kind == tuple[float, ...]]
        optional = [setting for setting in lists if model.setting(setting).optional]
        along = {key for dim in model.outputs[name].dims for key in (dim, f"{dim}s")}
        optional = [setting for setting in optional if setting in along] or optional
        yield InputFault(path, f"requires {choices(optional)} in [settings]", value)
    elif no_number and model.outputs[name].is_category:
        yield InputFault(path, f"is a category: {no_number}", value)


def _unit_faults(
    model: Model, name: str, path: tuple[str, ...], value: Any
) -> Iterator[InputFault]:
    """Yield a fault if the unit of a number is incompatible with its output."""
    output = model.outputs.get(name)  # None: undeclared before rows have run
    if output and output.is_lifetime and value is not None:
        if (read_quantity(value) if isinstance(value, str) else value) < 0:
            yield InputFault(path, "is before the start of the life", value)
    if output and output.is_angle and isinstance(value, float | int) and abs(value) > pi:
        yield InputFault(path, f"is more than half a turn [rad]; write '{value:g} degrees'", value)
    if output and isinstance(value, str) and (problem := misfit(value, name, output.unit)):
        if output.unit == "1" and isinstance(model.batch, RowByRow):
            of_life = output.is_lifetime
            python = "uq.Returned('s', life=True)" if of_life else "'m'"
            problem += (
                f"; '{name}' has no unit: declare it, in Python by returns={{'{name}': {python},"
                f" ...}}, in a machine file by unit = '{'s' if of_life else 'm'}'"
            )
        yield InputFault(path, problem, value)


def _twin_faults(model: Model, twin: Any, given: Mapping[str, Any]) -> Iterator[InputFault]:
    if isinstance(twin, dict):
        problems = read_settings(model, {**given, **twin})[1]
        for name, text in problems.items():
            if name in twin or not name:
                yield InputFault(
                    ("analysis", "twin", *filter(None, [name])), text, twin.get(name, twin)
                )
    elif twin and twin not in model.cheap:
        cheap = tuple(model.cheap)
        listed = f" ({', '.join(cheap)})" if cheap else ""
        problem = f"model '{model.name}' cannot compute it alone at a small part of the cost"
        remedy = f"; choose one that it can{listed}" if cheap else "; it has no such output"
        remedy += "; or give a table of settings that make rows cheap" * bool(model.setting_names)
        yield InputFault(("analysis", "twin"), f"{problem}{remedy}{nearest(twin, cheap)}", twin)


def design_faults(tables: Tables) -> Iterator[InputFault]:
    """Yield the faults of a study that its design causes: requests that it does not support."""
    table, analysis = tables["design"], tables["analysis"]
    if "method" not in table:
        return
    method = table["method"]
    design = DESIGNS[method]
    asks = {key for key, value in (*table.items(), *analysis.items()) if value}
    stated = "independent" in asks and design.imported
    imported, independent = _able(lambda d: d.imported), _able(lambda d: d.independent)
    problems = {}
    if "samples" in table and (problem := design.size_problem(table["samples"])):
        problems["samples"] = f"{problem} for '{method}'"
    problems |= dict(_nesting_problems(table, tables["uncertain"]))
    if "second_order" in asks and not design.crossed:
        problems["second_order"] = f"only for method = {_able(lambda d: d.crossed)}"
    if "independent" in asks and not stated:
        problems["independent"] = f"only for method = {imported}"
    if "until" in asks and not design.append_only:
        able = _able(lambda d: d.append_only)
        problems["until"] = f"a '{method}' design cannot grow; use method = {able}"
    elif "until" in asks:
        yield from _index_faults(design, method, table["until"], tables["uncertain"])
        paths = design.layout is PATHS and "index" in table["until"]  # paths are independent
        if not (design.independent or paths) and table.get("replicates", 1) < 2:
            problems["until"] = (
                f"a '{method}' design without replicates gives no interval; set replicates = 8"
            )
    for key, problem in problems.items():
        yield InputFault(("design", key), problem, None if key == "until" else table[key])
    several = table.get("units", 1) * table.get("repeats", 1) > 1
    for key in [bound for bound in ("tolerance", "joint_bounds") if bound in asks]:
        why = ""
        if several:
            why = f"independent rows, {_SEVERAL}"
        elif not design.independent and not stated:
            able = independent + ", independent = true if they are" * design.imported
            why = (
                f"independent rows, and those of '{method}' are not; use method = {able}, or leave"
                " the bound out"
            )
        if why:
            yield InputFault(
                ("analysis", key), f"refused: its confidence assumes {why}", analysis[key]
            )
    if "twin" in asks and several:
        problem = f"needs independent rows, {_SEVERAL}"
        yield InputFault(("analysis", "twin"), problem, analysis["twin"])
    elif "twin" in asks and not design.independent:
        why = (
            "needs rows that can be drawn, and imported rows cannot"
            if stated
            else f"needs independent rows, and those of '{method}' are not"
        )
        problem = f"{why}; use method = {independent}"
        yield InputFault(("analysis", "twin"), problem, analysis["twin"])
    unsaid = design.imported and not stated
    dependent = bool(tables["dependence"]) or unsaid
    yield from _method_faults(method, analysis.get("sensitivity", ()), dependent, unsaid)


def _index_faults(
    design: Design, method: str, until: Mapping[str, Any], uncertain: Mapping[str, Any]
) -> Iterator[InputFault]:
    """Yield the faults of the index in the stopping rule `until`."""
    if (index := until.get("index")) is None:
        return
    path, kinds = ("design", "until"), kinds_with_intervals(design)
    if not kinds:
        able = _able(lambda d: d.append_only and bool(kinds_with_intervals(d)))
        problem = f"a '{method}' design gives no index with an interval; use method = {able}"
        yield InputFault((*path, "index"), problem, index)
    elif index not in kinds:
        yield InputFault((*path, "index"), unknown("index with an interval", index, kinds), index)
    inputs = [name for name, law in uncertain.items() if "equals" not in law]
    if len(inputs) == 1 and design.layout is PATHS:
        problem = f"is 1 in every study of one input, {inputs[0]}: no interval to wait for"
        yield InputFault((*path, "index"), problem, index)
    for key in ("input", "difference"):
        given = until.get(key, [])
        for name in [given] if isinstance(given, str) else given:
            if name not in inputs:
                yield InputFault((*path, key), unknown("input with a law", name, inputs), given)


_SEVERAL = "and the units and repeats of one sample are not; set both to 1, or leave it out"


def _nesting_problems(
    table: Mapping[str, Any], uncertain: Mapping[str, Any]
) -> Iterator[tuple[str, str]]:
    """Yield key and problem of requested units or repeats that a design does not support."""
    units, repeats, method = table.get("units", 1), table.get("repeats", 1), table["method"]
    asked = [key for key in ("units", "repeats") if table.get(key, 1) > 1]
    if not asked:
        return
    if not DESIGNS[method].nests:
        able = _able(lambda d: d.nests)
        for key in asked:
            yield key, f"a sample of a '{method}' design has no {key}; use method = {able}"
    elif units * repeats > MAX_ROWS_OF_A_SAMPLE:
        problem = f"units x repeats must be at most {MAX_ROWS_OF_A_SAMPLE}: {units * repeats}"
        yield asked[0], problem
    elif most := DESIGNS[method].most_inputs:
        levels = [law.get("level", OWN) for law in uncertain.values() if "equals" not in law]
        if (size := dimension(levels, units, repeats)) > most:
            problem = (
                f"a sample then draws {size} numbers, and a point of a '{method}' design has at"
                f" most {most}; use method = {_able(lambda d: d.nests and d.independent)}"
            )
            yield asked[0], problem


def _method_faults(
    method: str, asked: Iterable[str], dependent: bool, unsaid: bool
) -> Iterator[InputFault]:
    """Yield a fault for each requested sensitivity method that a design does not support."""
    feeds, able = fed_by(DESIGNS[method]), fed_by(DESIGNS[method], dependent)
    if dependent and not able:
        return  # a fault of the design, reported there
    why = "[dependence] says they are not"
    if unsaid:
        why = "imported rows may be dependent (independent = true in [design] states otherwise)"
    for name in asked:
        problem = (
            f"a '{method}' design cannot feed it, method = {_names(designs_for(name))} can;"
            f" '{method}' feeds {_names(feeds)}"
        )
        if name in feeds:
            problem = f"assumes independent inputs, and {why}; those that do not are {_names(able)}"
        if name not in able:
            yield InputFault(("analysis", "sensitivity"), problem, name)


def _able(can: Callable[[Design], bool]) -> str:
    return _names(name for name, design in DESIGNS.items() if can(design))


def _names(names: Iterable[str]) -> str:
    return " or ".join(f"'{name}'" for name in names)
