"""A study is changed in Python by the places of its entries, and checked like a file."""

import numpy as np
import pytest

import uq
from uq.study.definition import study_from_text

STUDY = """
[study]
name = "rods"
model = "linear"
[design]
method = "monte-carlo"
samples = 64
[uncertain.x1]  # a comment
distribution = "normal"
mean = 0.5
sd = 0.05
source = "measured: 40 rods"
level = "shared"
[uncertain.x2]
distribution = "uniform"
lower = 0.1
upper = 0.9
[analysis]
tolerance = {coverage = 0.9, confidence = 0.95}
"""


@pytest.fixture
def study(folder):
    (folder / "rods.toml").write_text(STUDY)
    return uq.load_study("rods.toml")


def test_changed_entries_make_another_study_and_leave_the_first_as_it_is(study):
    changed = study.with_changes(
        {
            "study.name": "wider",
            "design.samples": np.int64(128),
            "design.units": 2,
            "analysis.tolerance": None,
            "uncertain.x1.sd": np.float64(0.1),
            "fixed.x4": 1,
            "analysis.thresholds": {"y": [1.0, 2.0]},
        }
    )
    assert (changed.name, changed.design.samples, changed.design.units) == ("wider", 128, 2)
    assert changed.uncertain["x1"].sd == 0.1
    assert changed.uncertain["x1"].source == "measured: 40 rods"
    assert changed.fixed == {"x4": 1.0}
    assert changed.analysis.thresholds == {"y": (1.0, 2.0)}
    assert (study.design.samples, study.uncertain["x1"].sd) == (64, 0.05)
    assert list(changed.uncertain) == list(study.uncertain)


def test_another_law_keeps_level_and_source_unless_it_states_its_own(study):
    law = {"distribution": "uniform", "lower": 0.2, "upper": 0.4}
    changed = study.with_changes({"uncertain.x1": law, "uncertain.x2": law | {"source": "chosen"}})
    first, second = changed.uncertain.values()
    assert (first.lower, first.upper, first.level) == (0.2, 0.4, "shared")
    assert first.source == "measured: 40 rods"
    assert second.source == "chosen"
    parts = {"distribution": "uniform", "lower": 0.2, "upper": 0.4}
    assert study.with_changes({f"uncertain.x1.{key}": value for key, value in parts.items()})


def test_none_removes_an_entry(study):
    changed = study.with_changes({"analysis.tolerance": None, "uncertain.x2": None})
    assert changed.analysis.tolerance is None
    assert list(changed.uncertain) == ["x1"]


def test_its_text_is_the_study(study):
    changed = study.with_changes({"uncertain.x1.sd": 0.1, "settings": {"fail_above": 3.0}})
    again = study_from_text(changed.text)
    assert again.identity == changed.identity != study.identity
    assert again.text == changed.text
    assert "[uncertain.x1]\n" in changed.text
    assert study.with_changes({}).identity == study.identity


def test_a_number_of_samples_set_before_stays(study):
    assert study.with_samples(7).with_changes({"fixed.x4": 1.0}).design.samples == 7


def test_a_changed_study_runs_as_the_file_of_its_text_does(study, folder):
    changed = study.with_changes({"study.name": "wider", "uncertain.x1.sd": 0.1})
    ds = uq.run(changed, workers=0)
    (folder / "wider.toml").write_text(changed.text)
    assert (folder / "results" / "wider.nc").is_file()
    assert ds.equals(uq.run("wider.toml", "again.nc", workers=0))


def test_what_if_and_a_new_run_take_the_same_changes(study):
    changes = {"uncertain.x1.sd": 0.04, "uncertain.x2": {"distribution": "beta", "alpha": 2.0}}
    changes["uncertain.x2"] |= {"beta": 2.0, "lower": 0.1, "upper": 0.9}
    expected = uq.what_if(uq.run(study.with_samples(1000), workers=0), changes)
    again = study.with_samples(1000).with_changes(changes)
    actual = uq.summary(uq.run(again, "again.nc", workers=0))
    assert actual.loc["y", "mean"] == pytest.approx(expected.loc["y", "mean"], rel=0.02)


@pytest.mark.parametrize(
    ("place", "value", "line"),
    [
        ("design.sampels", 3, "[design] sampels = 3: no such key; did you mean 'samples'?"),
        ("desing.samples", 3, "[desing]: no such table; did you mean 'design'?"),
        ("uncertain.x11.sd", 1.0, "'x11' is not uncertain in this study; did you mean 'x1'?"),
        ("uncertain.x1.ds", 1.0, "no such argument of x1's law"),
        ("uncertain.x9", {"distribution": "uniform", "lower": 0.0, "upper": 1.0}, "no such param"),
        ("analysis.tolerence", None, "no such entry to remove; did you mean 'tolerance'?"),
        ("design.samples.x", 3, "design.samples has no keys"),
        ("design.samples", object(), "must be a number, a text, a list or a mapping"),
        ("design", 3, "design = 3: must be a table"),
        ("study", None, "[study]: is missing"),
    ],
)
def test_a_mistake_is_one_line_with_the_nearest_name(study, place, value, line):
    with pytest.raises(uq.errors.InputError) as error:
        study.with_changes({place: value})
    assert str(error.value).startswith("rods.toml: ")
    assert line in str(error.value)
    assert len(error.value.lines) == 1


def test_rows_in_a_file_stay_those_that_were_read(folder):
    (folder / "rows.csv").write_text("x1,x2\n0.1,0.2\n0.3,0.4\n0.5,0.6\n")
    text = STUDY.partition("[analysis]")[0].replace("monte-carlo", "imported")
    text = text.replace("samples = 64", 'file = "rows.csv"')
    (folder / "rods.toml").write_text(text)
    study = uq.load_study("rods.toml")
    (folder / "rows.csv").unlink()
    changed = study.with_changes({"fixed.x4": 1.0})
    assert changed.imported == study.imported
    assert changed.design.samples == 3


def test_a_model_of_ones_own_and_another_model(folder):
    (folder / "pad.py").write_text(
        "import uq\n\n@uq.machine(returns={'y': '1'})\n"
        "def pad(x1: float = 1.0, x2: float = 2.0):\n    return {'y': x1 + x2}\n"
    )
    (folder / "rods.toml").write_text(STUDY)
    study = uq.load_study("rods.toml", model="pad.py").with_changes({"design.samples": 8})
    assert study.model.name == "pad"
    assert uq.run(study, workers=0).sizes["row"] == 8
    other = uq.load_study("rods.toml").with_changes({"study.model": "ishigami"})
    assert other.model.name == "ishigami"
