"""Laws whose values come from a file."""

import os

import pytest
from computed import as_text, asking, computed
from input_studies import UNIFORM, inputs_of, tables

from uq.result.result import Result
from uq.assess.comparison import comparison
from uq.errors import InputError
from uq.render.html.page import page
from uq.study.definition import load_study, study_from_text
from uq.study.row_sampling import row_block
from uq.text.numbers import law


@pytest.fixture
def springs(tmp_path):
    """Return a folder with a study and the measurements that it names."""
    (tmp_path / "springs.csv").write_text("k, note\n0.25, a\n0.5, b\n0.75, c\n0.5, d\n")
    entry = {"distribution": "empirical", "file": "springs.csv", "column": "k"}
    (tmp_path / "study.toml").write_text(as_text(tables({"x1": entry, "x2": UNIFORM})))
    return tmp_path


def test_an_empirical_law_draws_the_values_of_the_column(springs):
    study = load_study(springs / "study.toml")
    assert law(study.uncertain["x1"]) == 'empirical(file = "springs.csv", column = "k")'
    found = inputs_of(study)["x1"]
    assert set(found) == {0.25, 0.5, 0.75}
    assert (found == 0.5).mean() == pytest.approx(0.5, abs=0.04)


def test_a_result_needs_no_file(springs):
    study = load_study(springs / "study.toml")
    ds = computed(study)
    (springs / "springs.csv").unlink()
    again = study_from_text(ds.attrs["study"])
    assert again.identity == study.identity and again.text == study.text
    assert row_block(again, 0, 64).x.tobytes() == row_block(study, 0, 64).x.tobytes()


def test_a_result_is_reported_and_compared_without_the_file(springs, no_other_figures):
    ds = computed(load_study(springs / "study.toml"))
    (springs / "springs.csv").unlink()
    other = computed(study_from_text(as_text(tables({"x1": UNIFORM, "x2": UNIFORM}))))
    assert "empirical: file springs.csv, column k" in page(Result(ds), "springs.nc")
    stated = 'empirical(file = "springs.csv", column = "k")'
    (change,) = comparison(Result(ds), Result(other)).changed
    assert change.name == "x1" and change.first.startswith(stated)


def test_the_identity_is_of_what_the_file_holds_not_of_its_name(springs):
    study = load_study(springs / "study.toml")
    text = (springs / "study.toml").read_text()
    (springs / "springs.csv").rename(springs / "other.csv")
    (springs / "study.toml").write_text(text.replace("springs.csv", "other.csv"))
    assert load_study(springs / "study.toml").identity == study.identity
    (springs / "other.csv").write_text("k\n0.25\n0.5\n0.75\n0.6\n")
    assert load_study(springs / "study.toml").identity != study.identity


@pytest.mark.parametrize(
    ("held", "said"),
    [
        (None, "no such file in"),
        ("", "has no column 'k' (its columns: none)"),
        ("kk\n1\n", "has no column 'k'; did you mean 'kk'? (its columns: kk)"),
        ("k,k\n1,2\n", "has several columns 'k'; give each its own name (its columns: k, k)"),
        ("k, note\n0.5, a\n0.6\n", "line 3: has 1 cell, the first line 2; all rows"),
        ("k, note\n0.5, a\n0.6, b, c\n", "line 3: has 3 cells, the first line 2; all"),
        ("note, k\na, 0,5\n", "numbers a decimal point, not a comma"),
        (
            'k\n"0,5"\n',
            "line 2: column 'k' must be a finite number: '0,5'; write it with a decimal",
        ),
        (
            "note; k\na; 0,5\n",
            "has cells separated by semicolons; write commas, and a decimal point",
        ),
        ('"note";"k, N"; k\na;1,0;0,5\n', "has cells separated by semicolons; write commas"),
        ("note\tk\na\t0.5\n", "has cells separated by tabs; write commas, and a decimal point"),
        ("k\n0.5\nabc\n", "line 3: column 'k' must be a finite number: 'abc'"),
        ("k\n0.5\nnan\n", "line 3: column 'k' must be a finite number: 'nan'"),
        ("k\n", "has 0 rows (allowed: 1 to 1000000)"),
        ("k\n0.5\n0.5\n", "needs at least two different values"),
        ('k\n"0.5\n', "not CSV"),
    ],
)
def test_a_file_that_is_no_use_is_one_line(springs, held, said):
    (springs / "springs.csv").unlink()
    if held is not None:
        (springs / "springs.csv").write_text(held)
    with pytest.raises(InputError) as caught:
        load_study(springs / "study.toml")
    (line,) = caught.value.lines
    assert said in line and line.startswith(f"{springs}/study.toml: [uncertain.x1] ")


def test_only_a_file_is_read(springs):
    (springs / "springs.csv").unlink()
    for make, what in ((os.mkfifo, "a named pipe"), (os.mkdir, "a folder")):
        (springs / "springs.csv").unlink(missing_ok=True)
        make(springs / "springs.csv")
        with pytest.raises(InputError, match=f'"springs.csv": is {what}, not a file$'):
            load_study(springs / "study.toml")


def test_asking_of_a_result_still_works_with_files(springs):
    ds = computed(load_study(springs / "study.toml"))
    assert list(asking(ds, outputs=["y"]).attrs) == list(ds.attrs)
