"""A good study file becomes a Study: values, defaults, identity, and its way to a worker."""

import pickle
from dataclasses import replace

import pytest
from study_text import UNIFORM, study_text

from models.analytic import ISHIGAMI, LINEAR
from uq.errors import InputError
from uq.study.definition import load_study, study_from_text
from uq.study.reading import read_study_text

LINEAR_STUDY = """
study = {name = "faults", model = "linear", description = "what happens when rows fail"}
design = {method = "halton", samples = 50, replicates = 3, seed = 11}
fixed = {x4 = 1, x2 = 0.25}
settings = {fail_above = 1, fail_how = "raise"}
[uncertain.x3]
distribution = "uniform"
lower = 0
upper = 1
source = "a guess"
[uncertain.x1]
distribution = "beta"
alpha = 2
beta = 3
lower = 0
upper = 1
[analysis]
quantiles = [0.1, 0.9]
thresholds = {y = 5}
"""


def identity(changes=None, text=""):
    return study_from_text(study_text(changes) + text).identity


def test_every_entry_arrives(tmp_path):
    path = tmp_path / "faults.toml"
    path.write_text(LINEAR_STUDY)
    study = load_study(path)
    assert (study.name, study.model, study.model_reference) == ("faults", LINEAR, "linear")
    assert study.description == "what happens when rows fail"
    assert study.design.model_dump() == {
        "method": "halton",
        "samples": 50,
        "replicates": 3,
        "units": 1,
        "repeats": 1,
        "second_order": False,
        "seed": 11,
        "file": None,
        "independent": False,
        "until": None,
    }
    assert study.fixed == {"x4": 1.0, "x2": 0.25}
    assert list(study.uncertain) == ["x3", "x1"]
    assert study.uncertain["x3"].source == "a guess"
    assert (study.settings.fail_above, study.settings.fail_how) == (1.0, "raise")
    assert study.analysis.quantiles == (0.1, 0.9)
    assert study.analysis.thresholds == {"y": (5.0,)}
    assert (study.text, study.path) == (LINEAR_STUDY, str(path))


def test_whole_numbers_become_floats_where_floats_are_meant():
    study = study_from_text(LINEAR_STUDY)
    law = study.uncertain["x3"].model_dump()
    values = [study.fixed["x4"], law["upper"], study.settings.fail_above]
    assert {type(value) for value in values} == {float}


def test_what_a_file_leaves_out_has_a_default():
    study = study_from_text(study_text({"design": {"seed": None}}))
    assert (study.design.replicates, study.design.second_order, study.design.seed) == (1, False, 0)
    assert study.fixed == {}
    assert study.settings == ISHIGAMI.settings()
    analysis = study.analysis
    assert (analysis.outputs, analysis.quantiles) == (("y",), (0.05, 0.5, 0.95))
    assert (analysis.max_failed, analysis.tolerance) == (0.1, None)
    assert (analysis.thresholds, analysis.sensitivity) == ({}, ())


def test_a_tolerance_is_a_coverage_and_a_confidence():
    wanted = {"tolerance": {"coverage": 0.95, "confidence": 0.9}, "thresholds": {"y": [1, 2.5]}}
    analysis = study_from_text(study_text({"analysis": wanted})).analysis
    assert analysis.tolerance == (0.95, 0.9)
    assert analysis.tolerance._fields == ("coverage", "confidence")
    assert analysis.thresholds == {"y": (1.0, 2.5)}


def test_the_text_of_a_result_is_read_without_its_model():
    file = read_study_text(study_text({"study": {"model": "not-installed-here"}}))
    assert file.study.model == "not-installed-here"
    assert file.analysis.quantiles == (0.05, 0.5, 0.95)
    with pytest.raises(InputError, match=r"^result.nc: \[study\] modle = 1: no such key"):
        read_study_text(study_text({"study": {"modle": 1}}), "result.nc")


def test_a_byte_order_mark_and_windows_line_ends_do_no_harm(tmp_path):
    path = tmp_path / "windows.toml"
    path.write_bytes(b"\xef\xbb\xbf" + study_text().replace("\n", "\r\n").encode())
    assert load_study(path).identity == identity()


def test_a_model_given_beside_the_file_wins():
    text = study_text({"study": {"model": "unheard-of"}})
    study = study_from_text(text, model="models.analytic:ISHIGAMI")
    assert study.model is ISHIGAMI
    assert study.model_reference == "models.analytic:ISHIGAMI"


@pytest.mark.parametrize(
    "changes",
    [
        {"design": {"samples": 128}},
        {"design": {"replicates": 1, "second_order": False}},
        {"study": {"name": "another-name", "description": "other words"}},
        {"analysis": {"quantiles": [0.5], "max_failed": 0.5}},
        {"uncertain": {"x1": {**UNIFORM, "source": "measured"}}},
    ],
    ids=["samples", "defaults-written-out", "name", "analysis", "source"],
)
def test_the_identity_ignores_what_changes_no_row(changes):
    assert identity(changes, "\n# a comment") == identity()


@pytest.mark.parametrize(
    "changes",
    [
        {"design": {"method": "halton"}},
        {"design": {"seed": 8}},
        {"design": {"replicates": 2}},
        {"uncertain": {"x1": {"distribution": "uniform", "lower": -3, "upper": 3}}},
        {"uncertain": {"x3": None}},
        {"uncertain": {"x3": None}, "fixed": {"x3": 1.0}},
    ],
)
def test_the_identity_changes_with_whatever_changes_a_row(changes):
    others = [identity(), identity({"uncertain": {"x3": None}, "fixed": {"x3": 2.0}})]
    assert identity(changes) not in others


def test_the_identity_depends_on_the_order_of_the_columns_and_on_settings():
    study = study_from_text(LINEAR_STUDY)
    head, x3, x1 = LINEAR_STUDY.partition("[analysis]")[0].split("[uncertain.")
    swapped = f"{head}[uncertain.{x1}\n[uncertain.{x3}"
    assert study_from_text(swapped).identity != study.identity
    kinder = LINEAR_STUDY.replace('fail_how = "raise"', 'fail_how = "nan"')
    assert study_from_text(kinder).identity != study.identity
    explicit = LINEAR_STUDY.replace("fail_above = 1,", "fail_above = 1.0,")
    assert study_from_text(explicit).identity == study.identity


def test_the_identity_depends_on_the_model_and_its_version():
    study = study_from_text(study_text())
    for change in ({"version": "2"}, {"name": "other"}):
        assert replace(study, model=replace(ISHIGAMI, **change)).identity != study.identity


def test_the_identity_is_the_one_of_old_results():
    # Another value here means that results on disk no longer belong to their studies.
    assert identity() == "6a90c2778079adf54b82bb652b4b5c5312f5775ab0dae3ff3c22ee52b5dc94ad"


def test_more_samples_are_the_same_study():
    study = study_from_text(study_text({"design": {"method": "sobol"}}))
    more = study.with_samples(1024)
    assert (more.design.samples, more.identity) == (1024, study.identity)
    assert study.design.samples == 64


@pytest.mark.parametrize("method", ["sobol", "saltelli"])
def test_a_wrong_size_from_the_command_line_names_the_option(method):
    study = study_from_text(study_text({"design": {"method": method}}))
    with pytest.raises(InputError) as caught:
        study.with_samples(1000)
    assert caught.value.lines == (
        f"samples = 1000: must be a power of two, 512 or 1024, for '{method}'",
    )
    with pytest.raises(InputError, match="^samples = 0: must be between 1 and"):
        study.with_samples(0)


def test_a_study_travels_to_another_process():
    study = study_from_text(LINEAR_STUDY)
    back = pickle.loads(pickle.dumps(study))
    assert back == study
    assert back.identity == study.identity
