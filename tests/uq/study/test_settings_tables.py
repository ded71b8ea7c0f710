"""Settings that are tables, or rows of a file."""

import pytest

from uq.errors import InputError
from uq.study.definition import study_from_text
from uq.study.schema import json_schema

STUDY = """
[study]
name = "rod"
model = "gap-wear"
[design]
method = "monte-carlo"
samples = 4
[uncertain.wear_coefficient]
distribution = "lognormal"
median = 1e-14
sigma = 0.5
[settings]
"""
FILE = 'gap_history = {file = "gap.csv", columns = ["t", "x"]}\n'
DUTY = """
[[settings.duty]]
name = "full power"
share = 0.8
[[settings.duty]]
name = "standby"
share = 0
"""


def lines(text, folder=None):
    with pytest.raises(InputError) as caught:
        study_from_text(STUDY + text, folder=folder)
    return caught.value.lines


def test_tables_are_pairs_in_the_order_of_the_file():
    study = study_from_text(STUDY + DUTY)
    first, second = study.settings.duty
    assert first == (("name", "full power"), ("share", 0.8))
    assert dict(second) == {"name": "standby", "share": 0}
    hash(study.settings)


def test_rows_of_a_file_are_kept_in_the_text_of_the_study(tmp_path):
    (tmp_path / "gap.csv").write_text("t,x\n0,0\n1e7,1e-5\n")
    study = study_from_text(STUDY + FILE, folder=tmp_path)
    assert study.settings.gap_history == ((0.0, 0.0), (1e7, 1e-5))
    (tmp_path / "gap.csv").unlink()
    again = study_from_text(study.text)
    assert again.settings == study.settings
    assert again.text == study.text
    plain = study_from_text(STUDY + "gap_history = [[0, 0], [1e7, 1e-5]]")
    assert plain.settings == study.settings


def test_settings_that_are_no_tables_or_rows_are_refused(tmp_path):
    (line,) = lines("duty = [1.0]")
    assert line.endswith("must be a list, each a table of texts and numbers")
    (line,) = lines("duty = [{share = true}]")
    assert "must be a list, each a table of texts and numbers" in line
    (tmp_path / "gap.csv").write_text("t,x\n0,0\n2,1e-5\n1,1e-5\n")
    (line,) = lines(FILE, tmp_path)
    assert "gap_history must ascend in time: 1 s follows 2 s" in line
    (tmp_path / "gap.csv").write_text("t,y\n0,0\n")
    (line,) = lines(FILE, tmp_path)
    assert "has no column 'x'" in line
    (tmp_path / "gap.csv").unlink()
    (line,) = lines(FILE, tmp_path)
    assert "no such file" in line
    (line,) = lines('gap_history = "gap.csv"')
    assert line.endswith('or {file = "NAME.csv", columns = ["A", "B"]}')


def test_an_output_at_instants_names_the_setting_that_it_needs():
    (line,) = lines('[analysis]\noutputs = ["worn_depth"]')
    assert line.endswith("requires instants in [settings]")


def test_the_schema_has_tables_and_numbers_of_any_name():
    text = str(json_schema())
    value = {"type": ["string", "number"]}
    assert f"'items': { ({'additionalProperties': value}) }" in text
    assert "'type': ['object', 'array'], 'maxItems': 0" in text  # a table


LAW = """
wear_law = "power"
[settings.wear_law_numbers]
exponent = 2
"""


def test_a_setting_may_be_a_table():
    study = study_from_text(STUDY + LAW)
    assert dict(study.settings.wear_law_numbers) == {"exponent": 2}
    assert (
        study_from_text(STUDY + "wear_law_numbers = []").identity == study_from_text(STUDY).identity
    )
    (line,) = lines(LAW.replace("exponent", "decay"))
    assert "wear law 'power' has no 'decay'; it takes exponent, threshold" in line


def test_depths_have_units_or_are_shares_of_a_wall():
    text = STUDY.replace("gap-wear", "beam") + 'depths = ["20 um", 3e-5, "40 %"]\n'
    study = study_from_text(text + "wall_thickness = 5e-4")
    assert study.settings.depths == (2e-5, 3e-5, 2e-4)
    for depth, words in (("20 %", "needs wall_thickness"), ("3 kg", "a number of metres")):
        with pytest.raises(InputError) as caught:
            study_from_text(STUDY.replace("gap-wear", "beam") + f'depths = ["{depth}"]')
        assert words in str(caught.value)
    with pytest.raises(InputError, match="within 1e-09 to 0.1"):
        study_from_text(STUDY.replace("gap-wear", "beam") + 'depths = ["2 m"]')
