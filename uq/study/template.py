"""A study file to start from, written for one model."""

import re
from collections.abc import Iterator
from math import isfinite
from typing import Any

from pydantic import BaseModel

from uq.contract import Model, Parameter
from uq.designs.registry import DESIGNS
from uq.inputs.conditioning import law_problem
from uq.inputs.distributions import LogNormal, Normal, Uniform
from uq.inputs.law import Law
from uq.inputs.registry import LAWS
from uq.inputs.values import bounds_of
from uq.literals import toml
from uq.study.file import AnalysisTable, DesignTable

_UNCERTAIN = 3


def template(model: Model) -> str:
    """Return a commented study file that runs as it is.

    A line that starts with ``#`` and a key is an entry with its default: remove the ``#`` to
    change it. The first parameters that an example law suits are uncertain.

    Parameters
    ----------
    model : Model

    Returns
    -------
    str
        TOML.
    """
    laws = _example_laws(model)
    return "\n".join(
        [
            "#:schema vibrolife-study.schema.json",
            "# The line above lets an editor help; 'uq schema' writes that file.",
            "# '#key = value' shows a default: remove the '#' and change it.",
            "",
            "[study]",
            f"name = {toml(re.sub(r'[^A-Za-z0-9_-]', '-', model.name) + '-study')}",
            f"model = {toml(model.name)}",
            f"description = {toml(_line(model.title))}",
            "",
            "[design]",
            *(f"# {name}: {design.meaning}" for name, design in DESIGNS.items()),
            *_entries(
                DesignTable,
                {"method": "monte-carlo", "samples": 1000, "seed": 1},
                {"until": {"output": _numbers(model)[0], "half_width": 1.0}},
            ),
            "",
            "[fixed]",
            "# Parameters that keep one value; the nominal one unless given here.",
            *_fixed(model, laws),
            "",
            *_uncertain(model, laws),
            "# Other laws and their arguments, in the parameter's unit:",
            *_menu(),
            "",
            "[settings]",
            *_settings(model),
            "",
            "[analysis]",
            *_entries(AnalysisTable, {}, _analysis_examples(model)),
            "",
        ]
    )


def _example_laws(model: Model) -> dict[str, Law]:
    laws: dict[str, Law] = {}
    for name, nominal in model.nominal.items():
        law = _example_law(model.parameter(name), nominal)
        if law is not None and len(laws) < _UNCERTAIN:
            laws[name] = law
    return laws


def _example_law(parameter: Parameter, nominal: float) -> Law | None:
    """Return a law around the nominal value that the bounds allow: 10 % scatter if it can be.

    A parameter that is infinite unless given has none.
    """
    if not isfinite(nominal):
        return None
    source = "example: replace by what you know"
    candidates: list[Law] = []
    if nominal > 0:
        candidates.append(LogNormal(distribution="lognormal", mean=nominal, cv=0.1, source=source))
    low, high = parameter.bounds
    if low < high and isfinite(high - low):
        candidates.append(Uniform(distribution="uniform", lower=low, upper=high, source=source))
    candidates.append(Normal(distribution="normal", mean=nominal, sd=1.0, source=source))
    return next((law for law in candidates if law_problem(law, parameter) is None), None)


def _fixed(model: Model, laws: dict[str, Law]) -> Iterator[str]:
    for name, nominal in model.nominal.items():
        if name not in laws:
            yield _about(model.parameter(name))
            yield f"#{name} = {toml(nominal)}"


def _uncertain(model: Model, laws: dict[str, Law]) -> Iterator[str]:
    for name, law in laws.items():
        yield f"[uncertain.{name}]"
        yield _about(model.parameter(name))
        for key, value in law.model_dump(exclude={"source"}, exclude_none=True).items():
            yield f"{key} = {toml(value)}"
        yield f"source = {toml(law.source)}"
        yield ""


def _menu() -> Iterator[str]:
    common = ("distribution", *Law.model_fields)
    for name, law in LAWS.items():
        own = [key for key in law.model_fields if key not in common]
        arguments = ", or ".join(", ".join(names) for names in law.either or [own])
        yield f"# {name}: {arguments}"
    yield "# Any of them may be cut: truncate = [lower, upper]"
    yield '# A law may be that of a factor on another uncertain parameter: times = "other"'
    yield '# A parameter may be the same as another, instead of a law: equals = "other"'
    yield ""
    yield "# Rank correlations, with ones on the diagonal:"
    yield "# [dependence]"
    yield '# parameters = ["one", "other"]'
    yield "# rank_correlation = [[1.0, 0.5], [0.5, 1.0]]"


def _settings(model: Model) -> Iterator[str]:
    if not model.setting_names:
        yield "# This model has none."
    default = model.settings()
    for name in model.setting_names:
        declared = model.setting(name)
        allowed = ""
        if declared.choices:
            allowed = f"; one of {', '.join(declared.choices)}"
        elif declared.bounds is not None:
            allowed = f"; {declared.bounds[0]!r} to {declared.bounds[1]!r}"
        unit = "" if declared.unit == "1" else f" [{declared.unit}]"
        yield f"# {_line(declared.meaning)}{unit}{allowed}"
        yield f"#{name} = {toml(getattr(default, name))}"


def _numbers(model: Model) -> list[str]:
    return [name for name, output in model.outputs.items() if not output.is_category]


def _analysis_examples(model: Model) -> dict[str, Any]:
    return {
        "outputs": list(model.outputs),
        "tolerance": {"coverage": 0.95, "confidence": 0.95},
        "thresholds": {name: 1.0 for name in _numbers(model)[:1]},
        "sensitivity": ["rbd-fast"],
    }


def _entries(
    table: type[BaseModel], given: dict[str, Any], examples: dict[str, Any] | None = None
) -> Iterator[str]:
    for name, field in table.model_fields.items():
        if field.default is None and name not in (examples or {}):
            continue  # what few studies have, and TOML has no word for nothing
        yield f"# {field.description}"
        if name in given:
            yield f"{name} = {toml(given[name])}"
        else:
            yield f"#{name} = {toml((examples or {}).get(name, field.default))}"


def _about(parameter: Parameter) -> str:
    return _line(f"# {parameter.symbol}: {parameter.meaning}; {bounds_of(parameter)}")


def _line(text: str) -> str:
    return " ".join(text.split())
