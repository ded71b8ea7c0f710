"""``uq init --from``: a shipped or own study under another design and name."""

from pathlib import Path

import pytest

from uq.execution.loading import load_study
from uq.study.definition import study_from_text
from uq.study.template import variant

STUDIES = Path(__file__).parents[3] / "studies"


@pytest.mark.parametrize("method", ["saltelli", "morris", "fast", "shapley", "sobol", "rbd-fast"])
@pytest.mark.parametrize("name", ["exponential-wear", "beam-lifetime", "vibrator-startup"])
def test_a_variant_is_a_study_of_the_same_inputs_with_replicates(name, method):
    study = load_study(STUDIES / f"{name}.toml")
    made = study_from_text(variant(study, method, "mine"))
    assert (made.name, made.design.method, made.design.replicates) == ("mine", method, 8)
    assert made.uncertain == study.uncertain and made.fixed == study.fixed
    assert made.settings == study.settings
    assert made.analysis.thresholds == study.analysis.thresholds
    assert made.analysis.tolerance is None  # it assumes independent rows


def test_a_copy_has_the_same_rows():
    study = load_study(STUDIES / "exponential-wear.toml")
    copy = study_from_text(variant(study))
    assert copy.name == "exponential-wear-copy" and copy.identity == study.identity


def test_the_command_prints_a_study_that_can_be_run(uq, folder):
    out = uq("init", "--from", STUDIES / "exponential-wear.toml", "--design", "saltelli").out
    (folder / "mine.toml").write_text(out)
    assert 'name = "exponential-wear-saltelli"' in out
    assert uq("check", "mine.toml").code == 0


@pytest.mark.parametrize(
    ("given", "line"),
    [
        (("--from", "no.toml"), "no.toml: no such file"),
        (("--from", "{}", "--design", "saltell"), "did you mean 'saltelli'?"),
        (("beam", "--model", "pad.py"), "goes with --from STUDY"),
        (("beam", "--from", "{}"), "give one of MODEL, --from STUDY and --machine NAME"),
    ],
)
def test_a_mistake_is_one_line(uq, folder, given, line):
    file = str(STUDIES / "exponential-wear.toml")
    ended = uq("init", *(word.replace("{}", file) for word in given))
    assert (ended.code, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert line in ended.err
