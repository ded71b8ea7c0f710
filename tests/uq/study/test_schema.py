"""The JSON Schema accepts good studies and points at the entries of bad ones."""

import json
import tomllib
from importlib.metadata import EntryPoint

import pytest
from jsonschema import Draft7Validator
from study_text import UNIFORM, study_text

from uq.sampling.laws import LAWS
from uq.study import installed_models
from uq.study.file import AnalysisTable, DesignTable
from uq.study.installed_models import find_model, model_names
from uq.study.schema import json_schema
from uq.study.template import template


def make_validator():
    schema = json.loads(json.dumps(json_schema(), allow_nan=False))
    Draft7Validator.check_schema(schema)
    return Draft7Validator(schema)


@pytest.fixture(scope="module")
def validator():
    return make_validator()


def faults(validator, changes=None, text=None):
    data = tomllib.loads(study_text(changes) if text is None else text)
    return {"/".join(map(str, error.absolute_path)) for error in validator.iter_errors(data)}


def test_a_good_study_is_valid(validator):
    assert faults(validator) == set()
    until = {"output": "y", "half_width": 0.1, "above": 3}
    assert faults(validator, {"design": {"until": until}}) == set()


@pytest.mark.parametrize("name", model_names())
def test_the_template_of_every_model_is_valid(validator, name):
    assert faults(validator, text=template(find_model(name))) == set()


@pytest.mark.parametrize(
    ("changes", "place"),
    [
        ({"study": {"model": "ishigmi"}}, "study/model"),
        ({"study": {"name": None}}, "study"),
        ({"study": {"modle": "x"}}, "study"),
        ({"desing": {"seed": 1}}, ""),
        ({"design": {"method": "monte_carlo"}}, "design/method"),
        ({"design": {"method": "sobol", "samples": 1000}}, "design/samples"),
        ({"design": {"method": "saltelli", "samples": 1000}}, "design/samples"),
        ({"design": {"samples": 1.5}}, "design/samples"),
        ({"design": {"samples": True}}, "design/samples"),
        ({"design": {"samples": None}}, "design"),
        ({"design": {"second_order": True}}, "design/second_order"),
        ({"design": {"until": {"output": "y", "half_width": 0}}}, "design/until/half_width"),
        ({"design": {"until": {"output": "y"}}}, "design/until"),
        (
            {"design": {"method": "latin-hypercube", "until": {"output": "y", "half_width": 1}}},
            "design/until",
        ),
        ({"analysis": {"twin": "y"}}, "analysis/twin"),
        ({"analysis": {"twin": {"modes": 2}}}, "analysis/twin"),
        ({"uncertain": {"x4": UNIFORM}}, "uncertain"),
        ({"uncertain": {"x3": {**UNIFORM, "meen": 1}}}, "uncertain/x3"),
        ({"uncertain": {"x3": {"distribution": "normal", "mean": 0}}}, "uncertain/x3"),
        (
            {"uncertain": {"x3": {"distribution": "lognormal", "mean": 1, "sigma": 1}}},
            "uncertain/x3",
        ),
        ({"uncertain": {"x1": None, "x2": None, "x3": None}}, "uncertain"),
        ({"fixed": {"x4": 1.0}}, "fixed"),
        ({"fixed": {"x3": 5.0}}, "fixed/x3"),
        ({"settings": {"depth": 1}}, "settings"),
        ({"analysis": {"outputs": ["z"]}}, "analysis/outputs/0"),
        ({"analysis": {"thresholds": {"z": 1.0}}}, "analysis/thresholds"),
        ({"analysis": {"thresholds": {"y": True}}}, "analysis/thresholds/y"),
        ({"analysis": {"thresholds": {"y": "soon"}}}, "analysis/thresholds/y"),
        ({"analysis": {"wanted": {"z": "above"}}}, "analysis/wanted"),
        ({"analysis": {"wanted": {"y": "high"}}}, "analysis/wanted/y"),
        ({"analysis": {"quantiles": [0.5, 2]}}, "analysis/quantiles/1"),
        (
            {
                "design": {"method": "halton"},
                "analysis": {"tolerance": {"coverage": 0.9, "confidence": 0.9}},
            },
            "analysis/tolerance",
        ),
        ({"analysis": {"tolerance": {"coverage": 0.9}}}, "analysis/tolerance"),
        ({"analysis": {"sensitivity": ["sobol"]}}, "analysis/sensitivity/0"),
    ],
)
def test_the_fault_is_where_it_is(validator, changes, place):
    assert faults(validator, changes) == {place}


@pytest.mark.parametrize(
    "changes",
    [
        {"design": {"method": "saltelli", "second_order": True, "samples": 1024}},
        {"analysis": {"tolerance": {"coverage": 0.9, "confidence": 0.9}}},
        {"analysis": {"thresholds": {"y": [1, 2.5]}, "sensitivity": ["pawn"]}},
        {"analysis": {"thresholds": {"y": "5 %"}}},
        {"analysis": {"thresholds": {"y": [1, "5 %"]}, "wanted": {"y": "below"}}},
        {"uncertain": {"x3": {"distribution": "lognormal", "median": 1, "sigma": 0.1}}},
        {"settings": {}, "fixed": {}},
        {"uncertain": {"x3": None}, "fixed": {"x3": {"value": 1.0, "source": "rig: measured"}}},
        {"design": {"method": "imported", "file": "rows.csv", "samples": None}},
    ],
)
def test_what_a_study_may_say_is_valid(validator, changes):
    assert faults(validator, changes) == set()


def test_settings_of_a_model_carry_their_choices(validator):
    linear = {
        "study": {"model": "linear"},
        "uncertain": {"x2": None, "x3": None, "x1": {**UNIFORM, "lower": 0, "upper": 1}},
    }
    assert faults(validator, linear | {"settings": {"fail_how": "nan"}}) == set()
    assert faults(validator, linear | {"settings": {"fail_how": "no"}}) == {"settings/fail_how"}
    assert faults(validator, linear | {"settings": {"fail_above": "x"}}) == {"settings/fail_above"}


@pytest.mark.parametrize(
    ("points", "places"),
    [
        ([], set()),
        ([[1, 0.5], [-30.0, 30.0]], set()),
        ([1.0, 0.5], {"settings/body_points/0", "settings/body_points/1"}),
        ([[1.0]], {"settings/body_points/0"}),
        ([[1.0, 0.5, 0.0]], {"settings/body_points/0"}),
        ([[1.0, "x"]], {"settings/body_points/0/1"}),
        ([[31.0, 0.0]], {"settings/body_points/0/0"}),
    ],
)
def test_a_setting_may_be_a_list_of_pairs(validator, points, places):
    vibrator = {
        "study": {"model": "vibrator"},
        "uncertain": {"x1": None, "x2": None, "x3": None, "body_mass": UNIFORM},
    }
    assert faults(validator, vibrator | {"settings": {"body_points": points}}) == places


@pytest.fixture
def mounted(monkeypatch):
    """Return a validator, and the entries of [fixed], where the model MOUNTED is installed."""
    point = EntryPoint("mounted", "sample_models:MOUNTED", installed_models.GROUP)
    monkeypatch.setattr(installed_models, "_entry_points", lambda: {"mounted": point})
    validator = make_validator()
    rule = next(rule for rule in validator.schema["allOf"] if "study" in rule["if"]["properties"])
    return validator, rule["then"]["properties"]["fixed"]["properties"]


@pytest.mark.parametrize(
    ("fixed", "places"),
    [
        ("{}", set()),
        ("{mount_stiffness = inf}", set()),
        ("{mount_stiffness = 1e4}", set()),
        ("{mount_stiffness = 9999.0}", {"fixed/mount_stiffness"}),
        ("{mount_stiffness = -inf}", {"fixed/mount_stiffness"}),
    ],
)
def test_a_bound_at_infinity_is_none(mounted, fixed, places):
    validator, _ = mounted
    law = {"distribution": "uniform", "lower": 1.0, "upper": 2.0}
    changes = {
        "study": {"model": "mounted"},
        "uncertain": {"x1": None, "x2": None, "x3": None, "mass": law},
    }
    assert faults(validator, text=f"fixed = {fixed}\n{study_text(changes)}") == places


def test_what_is_infinite_is_left_out(mounted):
    _, entries = mounted
    kept = {
        name: {key: limits[key] for key in ("minimum", "maximum", "default") if key in limits}
        for name, entry in entries.items()
        for limits in [entry | entry["anyOf"][0]]
    }
    assert kept == {
        "mount_stiffness": {"minimum": 1e4},
        "mass": {"minimum": 0.0, "maximum": 1e3, "default": 2.0},
    }


def test_an_editor_can_explain_every_key(validator):
    for table in (DesignTable, AnalysisTable):
        for key, entry in validator.schema["definitions"][table.__name__]["properties"].items():
            assert entry.get("description"), key
    models = {
        rule["if"]["properties"]["study"]["properties"]["model"]["const"]: rule["then"]
        for rule in validator.schema["allOf"]
        if "study" in rule["if"]["properties"]
    }
    assert set(models) == set(model_names())
    for model_name, then in models.items():
        model = find_model(model_name)
        for wanted in ("fixed", "uncertain"):
            entries = then["properties"][wanted]["properties"]
            assert tuple(entries) == model.parameter_names
            for parameter, entry in entries.items():
                assert model.parameter(parameter).unit in entry["title"]
                assert model.parameter(parameter).meaning in entry["description"]
        assert tuple(then["properties"]["settings"]["properties"]) == model.setting_names


def test_nothing_may_be_null(validator):
    assert "null" not in json.dumps(validator.schema)
    assert set(LAWS) == {
        validator.schema["definitions"][reference["$ref"].rpartition("/")[2]]["properties"][
            "distribution"
        ]["const"]
        for reference in validator.schema["definitions"]["Law"]["oneOf"]
    }
