"""``uq models``: the list of models, and all that one of them declares."""

import pytest
from command_line import strict_json

from uq.cli import models
from uq.study.installed_models import find_model, model_names


def test_models_are_listed(uq):
    ended = uq("models")
    assert ended.code == 0
    listed = strict_json(uq("models", "--json").out)
    assert {"name", "version", "title"} == set(listed[0])
    for entry in listed:
        assert f"\n{entry['name']} " in ended.out
    assert {"beam", "ishigami", "g-function", "linear", "exponential-wear"} <= {
        entry["name"] for entry in listed
    }


def test_one_model_is_shown_in_full(uq):
    shown = uq("models", "linear").out
    line = "x1    x_1     0.5      0 to 1"
    for words in (line, "fail_how", "one of nan, inf, raise, shape", "y"):
        assert words in shown
    described = strict_json(uq("models", "linear", "--json").out)
    assert described["parameters"]["x1"] == {
        "nominal": 0.5,
        "symbol": "x_1",
        "unit": "1",
        "meaning": "independent input",
        "bounds": [0.0, 1.0],
        "source": "definition of the function",
    }
    assert described["settings"]["fail_how"]["default"] == "nan"
    assert described["outputs"]["y"]["unit"] == "1"
    assert uq("models", "liner").err.startswith("no such model 'liner'; did you mean 'linear'?")


def test_a_parameter_may_be_infinite_unless_given(uq):
    assert "k       inf N m⁻¹  10000 to inf" in uq("models", "sample_models:MOUNTED").out
    described = strict_json(uq("models", "sample_models:MOUNTED", "--json").out)
    shown = described["parameters"]["mount_stiffness"]
    assert (shown["nominal"], shown["bounds"]) == (None, [1e4, None])
    document = strict_json(uq("simulate", "sample_models:MOUNTED", "--json").out)
    assert document["inputs"] == {"mount_stiffness": None, "mass": 2.0}
    nominal = uq("simulate", "sample_models:MOUNTED")
    assert nominal.code == 0
    assert nominal == uq("simulate", "sample_models:MOUNTED", "--set", "mount_stiffness=inf")
    softer = uq("simulate", "sample_models:MOUNTED", "--set", "mount_stiffness=1e5")
    assert softer.out != nominal.out


@pytest.mark.parametrize("name", model_names())
def test_every_model_is_described_as_json(uq, name):
    described = strict_json(uq("models", name, "--json").out)
    assert described["name"] == name
    assert list(described) == [
        "name",
        "version",
        "title",
        "parameters",
        "settings",
        "outputs",
        "coordinates",
        "references",
    ]


@pytest.mark.parametrize("name", ["beam", "vibrator", "mole"])
@pytest.mark.parametrize("width", [60, 80])
def test_no_line_of_a_parameter_is_broken(name, width, monkeypatch, capsys):
    monkeypatch.setattr(models.console, "_width", width)
    model = find_model(name)
    models.show(model)
    lines = capsys.readouterr().out.split("Settings")[0].splitlines()
    for parameter in model.nominal:
        start = next(i for i, line in enumerate(lines) if line.split()[:1] == [parameter])
        assert lines[start + 1].startswith("    ")  # what explains it, not the rest of its line
        assert ("admissible: " in lines[start + 1]) == (width == 60)
    assert max(map(len, lines)) <= width
