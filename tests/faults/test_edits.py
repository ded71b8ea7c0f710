"""A study that is edited between runs: other rows are refused, more rows are appended."""

import pytest
from killed_runs import MODEL, OUT, ROWS, kept, until
from wordings import sentence

import uq


@pytest.mark.parametrize(
    ("old", "new", "change"),
    [
        ("seed = 5", "seed = 6", "[design] seed = 5, now 6"),
        pytest.param(
            *("upper = 0.9}", "upper = 0.8}", "[uncertain.x1] upper = 0.9, now 0.8"),
            marks=pytest.mark.slow,
        ),
        pytest.param(
            *("x2 =", "# x2 =", '[uncertain.x2] distribution = "uniform", no longer given'),
            marks=pytest.mark.slow,
        ),
    ],
)
def test_another_study_is_refused_with_what_changed(
    study, under_way, call, injected, old, new, change
):
    under_way(study).kill()
    before = {path.name for path in ROWS.iterdir()} - {"lock"}
    study.write_text(study.read_text().replace(old, new, 1))
    injected("study edited between runs")
    code, output = call("run", study, *MODEL)
    assert code == 2
    assert output == sentence("another study", rows=ROWS, change=change)
    assert before == {path.name for path in ROWS.iterdir()}
    assert call("run", study, *MODEL, "--fresh")[0] == 0


def test_comments_and_analysis_may_change(study, undisturbed, under_way, call, injected):
    under_way(study).kill()
    injected("study edited between runs", 2)
    study.write_text(study.read_text() + "# a comment\nquantiles = [0.5]\n")
    code, output = call("run", study, *MODEL[:-1])
    assert code == 0
    assert output.startswith(f"{OUT}: ") and " of 1500 rows " in output
    assert OUT.read_bytes() != undisturbed  # it holds the new text
    study.write_text(study.read_text().removesuffix("# a comment\nquantiles = [0.5]\n"))
    assert "already complete" in call("run", study, *MODEL[:-1])[1]
    assert call("verify", OUT, *MODEL[:2])[0] == 0


@pytest.mark.slow
def test_more_samples_are_appended_and_fewer_refused(study, undisturbed, under_way, call, injected):
    few = study.read_text().replace("samples = 1500", "samples = 900")
    many = study.read_text()
    study.write_text(few)
    under_way(study).kill()
    study.write_text(many)
    under_way(study).kill()  # it went on, with more
    injected("study edited between runs", 3)
    study.write_text(few)
    code, output = call("run", study, *MODEL)
    assert code == 2
    assert output.startswith(sentence("fewer", rows=ROWS, change="samples = 1500, now 900"))
    study.write_text(many)
    assert call("run", study, *MODEL)[0] == 0
    assert OUT.read_bytes() == undisturbed


@pytest.mark.slow
def test_an_extension_may_be_killed(study, undisturbed, start, call, injected):
    assert call("run", study, *MODEL, "--samples", "600")[0] == 0
    before = OUT.read_bytes()
    extend = ("extend", OUT, "--samples", "1500", *MODEL)
    run = start(*extend, UQ_TEST_SECONDS="0.01")
    until(lambda: kept().rows > 600 + 50)
    run.kill()
    injected("SIGKILL of an extension")
    assert kept().rows < 1500
    assert OUT.read_bytes() == before
    assert "is kept" in call("status", OUT)[1]
    assert call(*extend)[0] == 0
    assert OUT.read_bytes() == undisturbed


@pytest.mark.slow
def test_a_design_that_cannot_be_extended_says_so(write_study, under_way, call, injected):
    study = write_study(
        model="patient", uncertain=("x1", "x2"), method="latin-hypercube", samples=800
    )
    under_way(study).kill()
    study.write_text(study.read_text().replace("samples = 800", "samples = 900"))
    injected("study edited between runs")
    code, output = call("run", study, *MODEL)
    assert code == 2
    assert sentence("cannot be extended", design="latin-hypercube") in output


@pytest.mark.slow
def test_rows_of_an_edited_model_are_mixed_on_request_alone(
    study, under_way, call, folder, injected
):
    model = folder / "edited.py"
    options = ("--model", "edited:MODEL", "--workers", "0")
    model.write_text("from command import PATIENT as MODEL\n")
    under_way(study, *options).kill()
    model.write_text(model.read_text() + "# edited\n")
    injected("code of the model edited between runs", 2)
    refused = sentence("other code refused", output=OUT, model="patient")
    before = {path.name for path in ROWS.iterdir()} - {"lock"}
    assert call("run", study, *options) == (2, refused)
    assert before == {path.name for path in ROWS.iterdir()}
    assert call("run", study, *options, "--mixed", "--quiet") == (0, "")
    old, new = uq.open_result(OUT).attrs["code"].split("; ")
    code, output = call("verify", OUT, *options[:2])
    assert code == 0
    assert f"code  {old}; {new} made it, " in output
    printed = sentence("other code shown", output=OUT, model="patient")
    assert call("run", study, *options, "--quiet") == (0, printed)
    assert call("run", study, *options, "--quiet", "--mixed") == (0, "")
    for verb in (("extend", OUT, "--samples", "1600"), ("rerun", OUT, "--failed")):
        assert call(*verb, *options) == (2, refused)
        assert not ROWS.exists()
    assert call("extend", OUT, "--samples", "1600", *options, "--mixed", "--quiet") == (0, "")
    assert call("run", study, *options, "--fresh", "--quiet") == (0, "")
    assert len(uq.open_result(OUT).attrs["code"]) == 16
