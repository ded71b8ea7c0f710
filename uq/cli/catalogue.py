"""What ``uq models`` shows."""

from dataclasses import asdict
from math import isfinite
from typing import Any

from uq.cli.printing import console, grid, heading, number, paragraph
from uq.contract import Model, Setting
from uq.errors import InputError
from uq.study.registry import find_model, model_names


def list_models() -> list[dict[str, str]]:
    """Return name, version and title of every installed model."""
    return [_entry(name) for name in model_names()]


def _entry(name: str) -> dict[str, str]:
    try:
        model = find_model(name)
    except InputError as error:
        return {"name": name, "version": "", "title": str(error)}
    return {"name": name, "version": model.version, "title": model.title}


def as_json(model: Model) -> dict[str, Any]:
    """Return everything a model declares, as plain data."""
    defaults = model.settings()
    return {
        "name": model.name,
        "version": model.version,
        "title": model.title,
        "parameters": {
            name: {"nominal": nominal} | asdict(model.parameter(name))
            for name, nominal in model.nominal.items()
        },
        "settings": {
            name: {"default": getattr(defaults, name)} | asdict(model.setting(name))
            for name in model.setting_names
        },
        "outputs": {name: asdict(output) for name, output in model.outputs.items()},
        "coordinates": _coordinates(model),
        "references": list(model.references),
    }


def _coordinates(model: Model) -> dict[str, list[Any]]:
    return {dim: list(values) for dim, values in model.coordinates(model.settings()).items()}


def finite(value: Any) -> Any:
    """Return plain data with None for each number that is not finite, as JSON wants it."""
    match value:
        case dict():
            return {key: finite(item) for key, item in value.items()}
        case list() | tuple():
            return [finite(item) for item in value]
        case float() if not isfinite(value):
            return None
    return value


def show_list(listed: list[dict[str, str]]) -> None:
    """Print the models."""
    grid([list(entry.values()) for entry in listed], header=("model", "version", "title"), indent=0)
    console.print("\nuq models NAME shows one of them in full.")


def show(model: Model) -> None:
    """Print one model."""
    heading(model.name, f"{model.title} (version {model.version})")
    heading("\nParameters", "with meaning and source")
    lines = [_line(model, name) for name in model.parameter_names]
    header = ("name", "symbol", "nominal", "admissible")
    widths = [max(map(len, column)) for column in zip(header, *lines, strict=True)]
    fits = sum(widths) + 2 * (len(widths) - 1) <= console.width
    if fits:
        paragraph(_aligned(header, widths), indent=0)
    for line, name in zip(lines, model.parameter_names, strict=True):
        if fits:
            heading(line[0].ljust(widths[0]), _aligned(line[1:], widths[1:]))
        else:
            heading(line[0], line[1])
            paragraph(f"{line[2]}, admissible: {line[3]}")
        paragraph(model.parameter(name).meaning)
        paragraph(model.parameter(name).source)
    if model.setting_names:
        heading("\nSettings")
    defaults = model.settings()
    for name in model.setting_names:
        setting = model.setting(name)
        unit = "" if setting.unit == "1" else f" {setting.unit}"
        heading(f"  {name}", f"{getattr(defaults, name)}{unit}{_allowed(setting)}")
        paragraph(setting.meaning)
    heading("\nOutputs")
    for name, output in model.outputs.items():
        dims = f"({', '.join(output.dims)})" if output.dims else ""
        heading(f"  {name}{dims}", f"{output.kind} [{output.unit}]")
        paragraph(output.meaning)
        if output.categories:
            paragraph(", ".join(output.categories))
    if model.references:
        heading("\nReferences")
    for reference in model.references:
        paragraph(reference)


def _line(model: Model, name: str) -> tuple[str, str, str, str]:
    parameter = model.parameter(name)
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    bounds = " to ".join(map(number, parameter.bounds))
    return name, parameter.symbol, f"{model.nominal[name]:.6g}{unit}", bounds


def _aligned(cells: tuple[str, ...], widths: list[int]) -> str:
    padded = (cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
    return "  ".join(padded).rstrip()


def _allowed(setting: Setting) -> str:
    if setting.choices:
        return f", one of {', '.join(setting.choices)}"
    if setting.bounds:
        return ", " + " to ".join(map(number, setting.bounds))
    return ""
