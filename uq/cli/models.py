"""Terminal output of ``uq models``."""

from dataclasses import asdict
from typing import Any

from uq.cli.printing import console, grid, heading, number, paragraph
from uq.contract import Model, Parameter, Setting
from uq.errors import InputError
from uq.study.installed_models import find_model, model_names
from uq.text.numbers import listed
from uq.text.symbols import readable
from uq.text.units import powers


def list_models() -> list[dict[str, str]]:
    """Return name, version and title of every installed model, or why it cannot be imported."""
    listed = []
    for name in model_names():
        try:
            model = find_model(name)
            listed.append({"name": name, "version": model.version, "title": model.title})
        except InputError as error:
            listed.append({"name": name, "version": "", "title": str(error)})
    return listed


def as_json(model: Model) -> dict[str, Any]:
    """Return everything that a model declares, as plain data."""
    defaults = model.settings()
    return {
        "name": model.name,
        "version": model.version,
        "title": model.title,
        "parameters": {
            name: {"nominal": nominal} | _declared(model.parameter(name))
            for name, nominal in model.nominal.items()
        },
        "settings": {
            name: {"default": getattr(defaults, name)} | asdict(model.setting(name))
            for name in model.setting_names
        },
        "outputs": {name: asdict(output) for name, output in model.outputs.items()},
        "coordinates": {dim: list(values) for dim, values in model.coordinates(defaults).items()},
        "references": list(model.references),
    }


def _declared(parameter: Parameter) -> dict[str, Any]:
    """Return what a parameter declares; that it belongs to the initial condition only where so."""
    declared = asdict(parameter)
    return {name: value for name, value in declared.items() if name != "initial" or value}


def show_list(listed: list[dict[str, str]]) -> None:
    """Print the models."""
    grid([list(entry.values()) for entry in listed], header=("model", "version", "title"), indent=0)
    console.print("\nuq models NAME shows one of them in full.")


def show(model: Model) -> None:
    """Print one model."""
    heading(model.name, f"{model.title} (version {model.version})")
    heading("\nParameters", "with meaning and source")
    lines = [("name", "symbol", "nominal", "admissible")]
    lines += [_line(model, name) for name in model.parameter_names]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    padded = [[*map(str.ljust, line, widths)] for line in lines]
    fits = sum(widths) + 2 * (len(widths) - 1) <= console.width
    if fits:
        paragraph("  ".join(padded[0]).rstrip(), indent=0)
    for (name, symbol, nominal, bounds), cells in zip(lines[1:], padded[1:], strict=True):
        if fits:
            heading(cells[0], "  ".join(cells[1:]).rstrip())
        else:
            heading(name, symbol)
            paragraph(f"{nominal}, admissible: {bounds}")
        paragraph(readable(model.parameter(name).meaning))
        paragraph(model.parameter(name).source)
    if model.setting_names:
        heading("\nSettings")
    defaults = model.settings()
    for name in model.setting_names:
        setting = model.setting(name)
        unit = "" if setting.unit == "1" else f" {powers(setting.unit)}"
        heading(f"  {name}", f"{getattr(defaults, name)}{unit}{_allowed(setting)}")
        paragraph(setting.meaning)
    heading("\nOutputs")
    for name, output in model.outputs.items():
        dims = f"({', '.join(output.dims)})" if output.dims else ""
        unit = "" if output.unit == "1" else f" [{powers(output.unit)}]"
        heading(f"  {name}{dims}", f"{output.kind}{unit}")
        paragraph(readable(output.meaning))
        if output.categories:
            paragraph(listed(output.categories))
    if model.references:
        heading("\nReferences")
    for reference in model.references:
        paragraph(reference)


def _line(model: Model, name: str) -> tuple[str, str, str, str]:
    parameter = model.parameter(name)
    unit = "" if parameter.unit == "1" else f" {powers(parameter.unit)}"
    bounds = " to ".join(map(number, parameter.bounds))
    return name, parameter.symbol, f"{model.nominal[name]:.6g}{unit}", bounds


def _allowed(setting: Setting) -> str:
    if setting.choices:
        return f", one of {', '.join(setting.choices)}"
    if setting.bounds:
        return ", " + " to ".join(map(number, setting.bounds))
    return ""
