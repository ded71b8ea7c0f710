"""JSON Schema of a study file, for editors: keys, choices, and the names of each model."""

from contextlib import suppress
from math import isfinite
from typing import Any, get_args

from pydantic import TypeAdapter
from pydantic.json_schema import GenerateJsonSchema

from uq.contract import Model, Table
from uq.errors import InputError
from uq.indices.methods import fed_by
from uq.sampling.designs import DESIGNS, MAX_SAMPLES, Design
from uq.sampling.laws import LAWS
from uq.sampling.named_values import setting_types
from uq.study.file import StudyFile
from uq.study.installed_models import find_model, model_names
from uq.text.quantities import SHAPE

Schema = dict[str, Any]


def json_schema() -> Schema:
    """Return the JSON Schema of study files for the models installed here.

    It uses Draft 7, the newest draft that TOML plug-ins of editors support. Checks that require
    arithmetic (the probability of a law outside the bounds, the order of lower and upper) are left
    to ``uq check``.

    Returns
    -------
    dict
    """
    schema = StudyFile.model_json_schema(
        ref_template="#/definitions/{model}", schema_generator=_WithoutNull
    )
    definitions = schema["definitions"] = schema.pop("$defs")
    uncertain = schema["properties"]["uncertain"]
    laws, tied = uncertain["additionalProperties"]["oneOf"]
    for law in LAWS.values():
        properties = definitions[law.__name__]["properties"]
        definitions[law.__name__]["properties"] = {
            key: _with_units(argument) for key, argument in properties.items()
        }
    schema["properties"]["fixed"]["additionalProperties"] = _with_source(
        _with_units({"type": "number"})
    )
    definitions["Law"] = laws
    definitions["Entry"] = {"oneOf": [{"$ref": "#/definitions/Law"}, tied]}
    uncertain["additionalProperties"] = {"$ref": "#/definitions/Entry"}
    uncertain["minProperties"] = 1
    definitions["StudyTable"]["properties"]["model"]["enum"] = list(model_names())
    schema["allOf"] = [
        *(_when("study", "model", model.name, _model_schema(model)) for model in _models()),
        *(_when("design", "method", name, _design_schema(d)) for name, d in DESIGNS.items()),
    ]
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "$id": "vibrolife-study.schema.json",
        **schema,
        "title": "Study of a vibrolife model",
    }


class _WithoutNull(GenerateJsonSchema):
    """Pydantic's schema generator without null, which TOML lacks: optional keys may be absent."""

    def nullable_schema(self, schema: Any) -> Schema:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: Any) -> Schema:
        described = super().default_schema(schema)
        if described.get("default") is None:
            described.pop("default", None)
        return described


def _models() -> list[Model]:
    models = []
    for name in model_names():
        with suppress(InputError):  # a broken model is listed by name only
            models.append(find_model(name))
    return models


def _when(table: str, key: str, value: str, then: dict[str, Schema]) -> Schema:
    has_value = {"properties": {key: {"const": value}}, "required": [key]}
    return {
        "if": {"properties": {table: has_value}, "required": [table]},
        "then": {"properties": then},
    }


def _model_schema(model: Model) -> dict[str, Schema]:
    known_outputs = {"enum": list(model.outputs)}
    plain_outputs = {
        "enum": [
            n for n, output in model.outputs.items() if output.kind not in ("category", "lifetime")
        ]
    }
    settings = _table({name: _setting(model, name, k) for name, k in setting_types(model).items()})
    return {
        "fixed": _table({name: _fixed(model, name) for name in model.parameter_names}),
        "uncertain": _table(
            {
                name: {"allOf": [{"$ref": "#/definitions/Entry"}], **_texts(model, name)}
                for name in model.parameter_names
            }
        ),
        "settings": settings,
        "analysis": {
            "properties": {
                "outputs": {"items": known_outputs},
                "joint_bounds": {"propertyNames": known_outputs},
                "thresholds": {"propertyNames": known_outputs},
                "wanted": {"propertyNames": plain_outputs},
                "twin": {"anyOf": [{"enum": ["", *model.cheap]}, {"type": "object", **settings}]},
            }
        },
    }


def _design_schema(design: Design) -> dict[str, Schema]:
    absent: Schema = {"not": {}}
    powers = {"enum": [2**k for k in range(MAX_SAMPLES.bit_length())]}
    may_be_stated = design.independent or design.imported  # that rows are independent
    rules: list[tuple[str, bool, Schema]] = [
        ("samples", design.power_of_two, powers),
        ("second_order", not design.crossed, {"const": False}),
        ("samples", design.least > 1, {"minimum": design.least}),
        ("replicates", design.imported, {"const": 1}),
        ("units", not design.nests, {"const": 1}),
        ("repeats", not design.nests, {"const": 1}),
        ("file", not design.imported, absent),
        ("independent", not design.imported, {"const": False}),
        ("until", not design.append_only, absent),
    ]
    table = {key: rule for key, holds, rule in rules if holds}
    analysis: Schema = {"sensitivity": {"items": {"enum": list(fed_by(design))}}}
    analysis |= {} if design.independent else {"twin": {"const": ""}}
    analysis |= {} if may_be_stated else {"tolerance": absent, "joint_bounds": absent}
    needed: Schema = {} if design.imported else {"required": ["samples"]}
    return {"design": {"properties": table} | needed, "analysis": {"properties": analysis}}


def _table(properties: dict[str, Schema]) -> Schema:
    return {"properties": properties, "additionalProperties": False}


def _texts(model: Model, name: str) -> Schema:
    parameter = model.parameter(name)
    return {
        "title": f"{parameter.symbol} [{parameter.unit}]",
        "description": f"{parameter.meaning} (nominal {model.nominal[name]!r}: {parameter.source})",
    }


def _fixed(model: Model, name: str) -> Schema:
    nominal = model.nominal[name]
    default = {"default": nominal} if isfinite(nominal) else {}  # JSON has no infinity
    limits = _limits(model.parameter(name).bounds)
    number = {"type": ["number", "string"], "pattern": SHAPE}  # limits are of numbers alone
    return {**_with_source({**number, **limits}), **default, **_texts(model, name)}


def _with_source(number: Schema) -> Schema:
    """Return the schema of a number that may be in a table with its source."""
    entries = {"value": number, "source": {"type": "string"}}
    return {"anyOf": [number, {"type": "object", "required": ["value"], **_table(entries)}]}


def _setting(model: Model, name: str, kind: Any) -> Schema:
    declared = model.setting(name)
    pairs = {"additionalProperties": {"type": ["string", "number"]}}
    if kind == Table:
        schema: Schema = {"type": ["object", "array"], "maxItems": 0, **pairs}  # [] for none
    elif Table in get_args(kind):
        schema = {"type": "array", "items": pairs}
    else:
        schema = TypeAdapter(kind).json_schema()
    if declared.choices:
        schema["enum"] = list(declared.choices)
    schema = schema if declared.choices or "str" in str(kind) else _with_units(schema)
    schema = _limited(schema, {} if declared.bounds is None else _limits(declared.bounds))
    return {**schema, "title": f"{name} [{declared.unit}]", "description": declared.meaning}


def _with_units(schema: Schema) -> Schema:
    """Return a schema in which every number may be text with a number and its unit."""
    if schema.get("type") == "number":
        return {**schema, "type": ["number", "string"], "pattern": SHAPE}
    parts: Schema = {
        key: _with_units(schema[key]) for key in ("items",) if isinstance(schema.get(key), dict)
    }
    if "prefixItems" in schema:
        parts["prefixItems"] = [_with_units(item) for item in schema["prefixItems"]]
    return {**schema, **parts}


def _limited(schema: Schema, limits: Schema) -> Schema:
    """Return a schema with limits on every number, and lists of fixed length as in Draft 7."""
    if "prefixItems" in schema:
        items = [_limited(item, limits) for item in schema.pop("prefixItems")]
        return {**schema, "items": items}
    if "items" in schema:
        return {**schema, "items": _limited(schema["items"], limits)}
    return {**schema, **limits}


def _limits(bounds: tuple[float, float]) -> Schema:
    limits = zip(("minimum", "maximum"), bounds, strict=True)
    return {key: value for key, value in limits if isfinite(value)}
