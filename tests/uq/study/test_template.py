"""The study file of ``uq init`` runs as it is, and with every default written out."""

import re
import tomllib
from math import inf

import numpy as np
import pytest
from sample_models import MOUNTED

from uq.study.definition import load_study, study_from_text
from uq.study.installed_models import find_model, model_names
from uq.study.row_sampling import row_block
from uq.study.template import template


@pytest.mark.parametrize("name", model_names())
def test_a_template_is_a_study(name):
    model = find_model(name)
    study = study_from_text(template(model))
    constants = {key: x for key, x in model.nominal.items() if key not in study.uncertain}
    assert study.model == model.given(model.settings(), constants)
    assert study.settings == model.settings()
    if model.uncertain:  # as declared, each with its source
        assert list(study.uncertain) == list(model.uncertain)
        assert all(law.source for law in study.uncertain.values())
        assert study.analysis.outputs == model.headline
    else:
        assert 1 <= len(study.uncertain) <= 3
    x = row_block(study, 0, 100).x
    varying = [name in study.uncertain for name in model.parameter_names]
    np.testing.assert_array_equal((x != x[0]).any(axis=0), varying)


@pytest.mark.parametrize("name", model_names())
def test_every_commented_entry_is_a_default(name):
    model = find_model(name)
    text = re.sub(r"^#(\w+ = )", r"\1", template(model), flags=re.MULTILINE)
    study = study_from_text(text)
    data = tomllib.loads(text)
    assert data["fixed"].keys() | data["uncertain"].keys() == set(model.parameter_names)
    assert set(data["settings"]) == set(model.setting_names)
    assert study.identity == study_from_text(template(model)).identity


def test_a_parameter_that_is_infinite_unless_given_stays_fixed():
    text = template(MOUNTED)
    study = study_from_text(text, model="sample_models:MOUNTED")
    assert list(study.uncertain) == ["mass"]
    fixed = text.partition("[fixed]")[2].partition("[uncertain.mass]")[0]
    assert "# k: stiffness of the mount; 10000.0 to inf [N m-1]\n#mount_stiffness = inf\n" in fixed
    assert "mount_stiffness" not in text.replace(fixed, "")
    given = study_from_text(
        text.replace("#mount_stiffness", "mount_stiffness"), model=study.model_reference
    )
    assert given.fixed == {"mount_stiffness": inf}
    assert given.identity == study.identity


@pytest.mark.parametrize("name", model_names())
def test_every_parameter_is_explained(name):
    model = find_model(name)
    text = template(model)
    for parameter in model.parameter_names:
        declared = model.parameter(parameter)
        assert declared.meaning in text
        assert f"[{declared.unit}]" in text


@pytest.mark.parametrize("method", ["monte-carlo", "sobol", "saltelli", "morris", "fast"])
@pytest.mark.parametrize("model", ["beam", "exponential-wear"])
def test_a_new_study_may_have_a_name_and_a_design(uq, folder, model, method):
    folder.joinpath("a.toml").write_text(
        uq("init", model, "--name", "mine", "--design", method).out
    )
    study = load_study("a.toml")
    assert (study.name, study.design.method) == ("mine", method)
    assert study.design.replicates == (1 if method == "monte-carlo" else 8)
    assert (study.analysis.tolerance is None) == (
        method != "monte-carlo" or not study.model.headline
    )


@pytest.mark.parametrize(
    ("given", "line"),
    [
        (("beam", "-o", "a.toml"), "uq init prints the study: uq init beam > a.toml"),
        (("beam", "--design", "sobl"), "--design sobl: no such design; did you mean 'sobol'?"),
        (("beam", "--design", "imported"), "--design imported: needs a file of rows"),
        (("--machine", "pad", "--name", "x"), "uq init: --design and --name are of a study"),
    ],
)
def test_what_cannot_be_written_is_answered_with_what_can(uq, folder, given, line):
    ended = uq("init", *given)
    assert ended.code == 2 and ended.err.startswith(line)
    assert not [*folder.iterdir()]
