import sys
from dataclasses import replace
from importlib.metadata import EntryPoint
from typing import Annotated, NamedTuple

import pytest

from models import analytic
from models.analytic import LINEAR
from uq.contract import Model, Output, Parameter
from uq.errors import InputError
from uq.study import installed_models
from uq.study.installed_models import find_model, model_at, model_names


def message(reference):
    with pytest.raises(InputError) as caught:
        model_at(reference)
    (line,) = caught.value.lines
    return line


def test_the_models_with_known_answers_are_installed():
    names = {"ishigami", "g-function", "linear", "exponential-wear"}
    assert names <= set(model_names())
    for name in names:
        assert find_model(name).name == name


def test_a_wrong_name_gets_the_nearest_right_one():
    assert "no such model 'linaer'; did you mean 'linear'?" in message("linaer")


def test_a_model_is_found_where_it_lives():
    assert model_at("models.analytic:LINEAR") is LINEAR


def test_a_model_in_the_working_folder_is_found(tmp_path, monkeypatch):
    (tmp_path / "toy_model.py").write_text("from models.analytic import LINEAR as TOY\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    assert model_at("toy_model:TOY") is LINEAR


@pytest.mark.parametrize(
    ("reference", "words"),
    [
        ("models.analytic:", "package.module:ATTRIBUTE"),
        (":LINEAR", "package.module:ATTRIBUTE"),
        ("no_such_package:MODEL", "ModuleNotFoundError: No module named 'no_such_package'"),
        ("models.analytic:NOTHING", "AttributeError"),
        ("models.analytic:linear", "is a function, not a uq.contract.Model"),
        ("..:x", "cannot be imported"),
    ],
)
def test_a_reference_that_leads_nowhere_says_why(reference, words):
    assert words in message(reference)


def test_a_broken_model_is_one_line_and_leaves_the_others_alone(tmp_path, monkeypatch):
    (tmp_path / "broken_model.py").write_text("import sys\nsys.exit('no licence\\nfound')\n")
    monkeypatch.syspath_prepend(tmp_path)
    broken = EntryPoint("broken", "broken_model:MODEL", installed_models.GROUP)
    installed = installed_models._entry_points() | {"broken": broken}
    monkeypatch.setattr(installed_models, "_entry_points", lambda: installed)
    assert "broken" in model_names()
    assert "SystemExit: no licence found" in message("broken")
    assert isinstance(find_model("linear"), Model)


class Undeclared(NamedTuple):
    x1: float = 0.0


class WithoutNominal(NamedTuple):
    x1: Annotated[float, Parameter("x_1", "1", "input", (0.0, 1.0), "made up")]


class NotADataclass:
    pass


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"parameters": Undeclared}, "Undeclared.x1 is declared without a Parameter"),
        ({"parameters": WithoutNominal}, "parameter 'x1' has no nominal value"),
        (
            {"outputs": {"mode": Output("1", "which", "category", categories=("at rest",))}},
            "output 'mode': category 'at rest' must be one word",
        ),
        ({"settings": NotADataclass}, "must be called with a dataclass"),
    ],
)
def test_a_model_that_is_not_declared_is_refused(monkeypatch, change, words):
    monkeypatch.setattr(analytic, "ODD", replace(LINEAR, **change), raising=False)
    with pytest.raises(InputError, match=words):
        model_at("models.analytic:ODD")
