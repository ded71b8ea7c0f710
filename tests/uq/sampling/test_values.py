"""Values by name, for a model that has one setting of every kind."""

from dataclasses import dataclass
from math import inf, nan
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import pytest
from sample_models import MOUNTED
from study_text import study_text

from uq.contract import Model, Output, Parameter, Setting
from uq.errors import InputError
from uq.sampling.named_values import parameter_problem, read_settings
from uq.study.definition import study_from_text


class Inputs(NamedTuple):
    contact_stiffness: Annotated[
        float, Parameter("k_c", "N m-1", "stiffness", (1e2, 1e7), "assumed")
    ] = 13750.0


@dataclass(frozen=True)
class Numerics:
    depths: Annotated[tuple[float, ...], Setting("depths", "m", bounds=(1e-9, 0.1))] = (2.5e-4,)
    elements: Annotated[int, Setting("elements", bounds=(1, 40))] = 10
    horizon: Annotated[float, Setting("horizon", "s", bounds=(0.0, inf))] = inf
    propagator: Annotated[
        Literal["fast", "exact"], Setting("propagator", choices=("fast", "exact"))
    ] = "fast"
    label: Annotated[str, Setting("a word", choices=("a", "b"))] = "a"
    damped: Annotated[bool, Setting("whether to damp")] = True
    slope: Annotated[float, Setting("any number")] = 0.0
    points: Annotated[
        tuple[tuple[float, float], ...], Setting("points", "m", bounds=(-2.0, 2.0))
    ] = ()

    def __post_init__(self):
        if list(self.depths) != sorted(self.depths):
            raise ValueError("depths must increase")


def batch(x, seed, settings):
    outputs = {"y": x[:, 0].copy(), "life": x[:, 0].copy(), "regime": np.zeros(len(x), np.int8)}
    return outputs, np.zeros(len(x), np.int8)


TOY = Model(
    name="toy",
    title="one setting of each kind",
    version="1",
    parameters=Inputs,
    settings=Numerics,
    outputs={
        "y": Output("1", "the input"),
        "life": Output("s", "life", "lifetime", may_be_censored=False),
        "regime": Output("1", "kind", "category", categories=("only",)),
    },
    batch=batch,
)


@pytest.mark.parametrize(
    ("name", "value", "arrives"),
    [
        ("depths", [1.25e-4, 2.5e-4], (1.25e-4, 2.5e-4)),
        ("depths", [0.1], (0.1,)),
        ("elements", 40, 40),
        ("horizon", 1000, 1000.0),
        ("horizon", inf, inf),
        ("propagator", "exact", "exact"),
        ("damped", False, False),
        ("slope", -inf, -inf),
        ("points", [[1, 0.5], [-2.0, 2.0]], ((1.0, 0.5), (-2.0, 2.0))),
        ("points", [], ()),
    ],
)
def test_a_good_setting_arrives(name, value, arrives):
    settings, problems = read_settings(TOY, {name: value})
    assert problems == {}
    assert getattr(settings, name) == arrives
    assert type(getattr(settings, name)) is type(arrives)


@pytest.mark.parametrize(
    ("name", "value", "problem"),
    [
        ("depth", 1, "no such setting of model 'toy'; did you mean 'depths'?"),
        ("zzz", 1, "no such setting of model 'toy' (allowed: depths, elements, horizon,"),
        ("depths", 1.0, "must be a list, each a number within 1e-09 to 0.1 [m]"),
        ("depths", [1e-4, 1.0], "must be a list, each a number within 1e-09 to 0.1 [m]"),
        ("depths", [1e-4, "x"], "must be a list, each a number within 1e-09 to 0.1 [m]"),
        ("depths", [True], "must be a list, each a number within 1e-09 to 0.1 [m]"),
        ("depths", [nan], "must be a list, each a number within 1e-09 to 0.1 [m]"),
        ("elements", 10.0, "must be a whole number within 1 to 40"),
        ("elements", True, "must be a whole number within 1 to 40"),
        ("elements", 41, "must be a whole number within 1 to 40"),
        ("horizon", -1.0, "must be a number within 0.0 to inf [s]"),
        ("horizon", nan, "must be a number within 0.0 to inf [s]"),
        ("horizon", "soon", "must be a number within 0.0 to inf [s]"),
        ("propagator", "quick", "must be one of fast, exact"),
        ("propagator", 1, "must be one of fast, exact"),
        ("label", "c", "must be one of a, b"),
        ("damped", 1, "must be true or false"),
        *(
            ("points", points, "must be a list, each a list of 2, each a number within -2.0 to 2.0")
            for points in (1.0, [1.0, 0.5], [[1.0]], [[1.0, 0.5, 0.0]], [[1.0, "x"]], [[0.0, nan]])
        ),
        ("points", [[1.0, 0.5], [0.0, 2.1]], "must be a list, each a list of 2, each a number"),
        ("slope", nan, "must be a number"),
        ("slope", {"a": 1}, "must be a number"),
    ],
)
def test_a_wrong_setting_is_refused_with_what_it_must_be(name, value, problem):
    settings, problems = read_settings(TOY, {name: value})
    assert settings is None
    assert list(problems) == [name]
    assert problems[name].startswith(problem)


def test_settings_that_do_not_go_together_are_refused_by_the_model():
    assert read_settings(TOY, {"depths": [2e-4, 1e-4]}) == (None, {"": "depths must increase"})


@pytest.mark.parametrize(
    ("name", "value", "problem"),
    [
        ("contact_stiffness", 1e2, None),
        ("contact_stiffness", 10_000_000, None),
        ("contact_stiffness", -5.0, "must be within 100.0 to 10000000.0 [N m-1]"),
        ("contact_stiffness", nan, "must be within 100.0 to 10000000.0 [N m-1]"),
        ("contact_stiffness", "stiff", "must be a number"),
        ("contact_stiffness", True, "must be a number"),
        (
            "contact_stifness",
            1e3,
            "no such parameter of model 'toy'; did you mean 'contact_stiffness'?",
        ),
    ],
)
def test_a_parameter_is_checked_against_its_declaration(name, value, problem):
    assert parameter_problem(TOY, name, value) == problem


@pytest.mark.parametrize(
    ("value", "problem"),
    [
        (inf, None),
        (1e308, None),
        (1e3, "must be within 10000.0 to inf [N m-1]"),
        (-inf, "must be within 10000.0 to inf [N m-1]"),
        (nan, "must be within 10000.0 to inf [N m-1]"),
        (10**400, "must be a number"),
    ],
)
def test_a_bound_at_infinity_belongs_to_what_is_admissible(value, problem):
    assert parameter_problem(MOUNTED, "mount_stiffness", value) == problem


def test_infinity_lies_outside_finite_bounds():
    assert parameter_problem(MOUNTED, "mass", inf) == "must be within 0.0 to 1000.0 [kg]"


def test_a_study_reports_what_is_wrong_with_settings_and_categories():
    changes: dict[str, dict[str, Any]] = {
        "uncertain": {
            "x1": None,
            "x2": None,
            "x3": None,
            "contact_stiffness": {"distribution": "lognormal", "mean": 13750.0, "cv": 0.15},
        },
        "settings": {"depths": [2e-4, 1e-4]},
        "analysis": {
            "thresholds": {"regime": 1.0},
            "wanted": {"regime": "above", "life": "above", "Y": "below"},
        },
    }
    with pytest.raises(InputError) as caught:
        study_from_text(study_text(changes), "x.toml", model="test_values:TOY")
    assert caught.value.lines == (
        "x.toml: [settings]: depths must increase",
        "x.toml: [analysis] thresholds.regime = 1.0: is a category: it has shares, not thresholds",
        'x.toml: [analysis] wanted.regime = "above": is a category: it has shares, not sides',
        'x.toml: [analysis] wanted.life = "above": is a lifetime, whose model states if its end is'
        " wanted; leave it out",
        "x.toml: [analysis] wanted.Y = \"below\": no such output of model 'toy'; did you mean 'y'?",
    )
    changes["settings"] = {"elements": 0, "horizon": nan}
    with pytest.raises(InputError) as caught:
        study_from_text(study_text(changes), "x.toml", model="test_values:TOY")
    assert caught.value.lines[:2] == (
        "x.toml: [settings] elements = 0: must be a whole number within 1 to 40",
        "x.toml: [settings] horizon = nan: must be a number within 0.0 to inf [s]",
    )
