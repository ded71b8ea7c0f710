"""The tables of the models, made from their declarations."""

from dataclasses import fields
from pathlib import Path

from uq.contract import Status
from uq.study.installed_models import find_model, model_names, module_of
from uq.study.reading import read_study_text
from uq.text.numbers import listed
from uq.text.units import readable

from .markdown import formula, interval, minus, table, unit, value

_NO_MACHINES = {"models.analytic", "models.gap_wear"}


def machines() -> list[str]:
    """Return the names of the machines: no models with known answers."""
    return [name for name in model_names() if module_of(name) not in _NO_MACHINES]


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
                f"`{parameter}`<br>{readable(one.meaning)}",
                minus(stated),
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
        lines.append((f"`{field.name}`", default, allowed, readable(one.meaning)))
    return table(("setting", "default", "allowed", "meaning"), lines)


def outputs(name: str) -> str:
    """Tabulate the outputs of a model."""
    lines = []
    for output, one in find_model(name).outputs.items():
        meaning = readable(one.meaning) + (
            f"<br>{listed(one.categories)}" if one.categories else ""
        )
        more = [] if one.kind == "value" else [one.kind]
        more += ["may be undefined"] if one.may_be_undefined else []
        late = one.has_censored_flag and not one.never_known_at_once
        more += ["may never end if censored"] if late else []
        more += ["never censored"] if one.is_lifetime and not one.may_be_censored else []
        dims = f" ({', '.join(one.dims)})" if one.dims else ""
        lines.append((f"`{output}`{dims}", unit(one.unit), meaning, ", ".join(more)))
    return table(("output", "unit", "meaning", ""), lines)


def studies(name: str) -> str:
    """Tabulate the studies of a model that come with the project."""
    lines = []
    for path in sorted((Path(__file__).parents[2] / "studies").glob("*.toml")):
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
        (f"`{name}`", formula(one.symbol), unit(one.unit), readable(one.meaning), machine)
        for machine in model_names()
        for name in find_model(machine).nominal
        for one in [find_model(machine).parameter(name)]
    ]
    return table(("name", "symbol", "unit", "meaning", "model"), sorted(lines))


def all_outputs() -> str:
    """Tabulate every output of every model, by name."""
    lines = [
        (f"`{name}`", unit(one.unit), readable(one.meaning), machine)
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
