"""Quantities with units in [fixed], laws and settings, and hints on probable mistakes of typing."""

import pickle

import pytest

from uq.errors import InputError
from uq.study.definition import study_from_text, what_changed
from uq.study.file import source_of_fixed
from uq.study.hints import hints

TEXT = """
# A pad.
[study]
name = "pads"
model = "exponential-wear"
[design]
method = "monte-carlo"
samples = 100
[fixed]
depth = "2 mm" # as drawn
[uncertain.rate]
distribution = "lognormal"
mean = "1 nm/s"
cv = "15 %"
truncate = ["0.2 nm/s", 5e-9]
source = "worn by 2 mm"
[analysis]
thresholds = {life = "0.1 y"}
"""


def changed(old, new):
    assert old in TEXT
    return TEXT.replace(old, new)


def test_values_and_arguments_of_laws_may_have_units():
    study = study_from_text(TEXT)
    law = study.uncertain["rate"]
    assert study.fixed == {"depth": 0.002}
    assert (law.mean, law.cv, law.truncate) == (1e-9, 0.15, (2e-10, 5e-9))
    assert study.analysis.thresholds == {"life": (0.1 * 31557600,)}
    plain = changed('"2 mm" #', "2e-3 #").replace('"1 nm/s"', "1e-9").replace('"15 %"', "0.15")
    assert study.identity == study_from_text(plain.replace('"0.2 nm/s"', "2e-10")).identity


def test_the_text_of_the_study_has_the_numbers_and_keeps_its_comments():
    study = study_from_text(TEXT)
    assert "depth = 0.002 # as drawn" in study.text and "# A pad." in study.text
    assert 'source = "worn by 2 mm"' in study.text
    assert study_from_text(study.text).uncertain == study.uncertain


def test_a_text_that_is_a_quantity_by_chance_stays_a_text():
    study = study_from_text(changed('source = "worn by 2 mm"', 'source = "2 mm"'))
    assert study.uncertain["rate"].source == "2 mm" and study.fixed == {"depth": 0.002}
    assert study_from_text(study.text).uncertain["rate"].source == "2 mm"


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("2 mm", "2 kg", "[fixed] depth = \"2 kg\": the unit 'kg' does not fit 'depth'"),
        ("1 nm/s", "1 mm", "[uncertain.rate] mean = \"1 mm\": the unit 'mm' does not fit 'mean'"),
        ("0.2 nm/s", "0.2 s", "[uncertain.rate] truncate[0] = \"0.2 s\": the unit 's'"),
        ("1 nm/s", "much", '[uncertain.rate] mean = "much": must be a number'),
    ],
)
def test_a_unit_that_does_not_fit_is_a_fault(old, new, line):
    with pytest.raises(InputError) as caught:
        study_from_text(changed(f'"{old}"', f'"{new}"'))
    (fault,) = caught.value.lines
    assert fault.startswith(f"study: {line}")


def test_settings_may_have_units():
    text = TEXT.partition("[fixed]")[0].replace("exponential-wear", "beam")
    law = 'distribution = "uniform"\nlower = "200 um"\nupper = "0.3 mm"\n'
    text += (
        f'[uncertain.initial_gap]\n{law}[settings]\ndepths = ["125 um", 2.5e-4]\nhorizon = "9 y"'
    )
    study = study_from_text(text)
    assert study.settings.depths == (1.25e-4, 2.5e-4)
    assert study.settings.horizon == 9 * 31557600
    assert study.uncertain["initial_gap"].lower == pytest.approx(2e-4, rel=1e-15)


SOURCED = '{value = "2 mm", source = "drawing 7: given"}'


def test_a_fixed_value_may_state_its_source():
    study = study_from_text(changed('"2 mm" #', f"{SOURCED} #"))
    plain = study_from_text(TEXT)
    assert study.fixed == plain.fixed and study.identity == plain.identity
    assert source_of_fixed(study.fixed["depth"]) == "drawing 7: given"
    assert source_of_fixed(plain.fixed["depth"]) == ""
    assert 'depth = {value = 0.002, source = "drawing 7: given"} # as drawn' in study.text
    other = study_from_text(changed('"2 mm" #', "0.003 #"))
    assert what_changed(study.text, "1", other) == "[fixed] depth = 0.002, now 0.003"
    again = pickle.loads(pickle.dumps(study_from_text(study.text).fixed))
    assert again == plain.fixed and source_of_fixed(again["depth"]) == "drawing 7: given"


@pytest.mark.parametrize(
    ("entry", "problem"),
    [
        ('{valu = "2 mm"}', "has no key 'valu'; did you mean 'value'? (allowed: value, source)"),
        ('{source = "drawing 7"}', "must be a number, or {value = 1.5, source = "),
        ("{value = 1, source = 7}", "must be a number, or {value = 1.5, source = "),
        ('{value = "2 kg"}', "the unit 'kg' does not fit 'depth'"),
        ("{value = -1.0}", "must be within 0.0 to"),
    ],
)
def test_a_table_of_a_fixed_value_has_a_value_and_a_source_alone(entry, problem):
    with pytest.raises(InputError) as caught:
        study_from_text(changed('"2 mm" #', f"{entry} #"))
    (fault,) = caught.value.lines
    assert fault.startswith("study: [fixed] depth = ") and problem in fault


@pytest.mark.parametrize(
    ("old", "new", "remedy"),
    [
        ('life = "0.1 y"', "life = 12 days", '; text has quotes: "12 days"'),
        ('name = "pads"', "name = pads", '; text has quotes: "pads"'),
        ("5e-9]", "5e-9]\nmedian = 0,157", "; numbers have a decimal point: 0.157"),
        ("[analysis]", "[analysis", "; close the bracket: [analysis]"),
    ],
)
def test_a_fault_of_syntax_names_its_remedy(old, new, remedy):
    with pytest.raises(InputError) as caught:
        study_from_text(changed(old, new))
    assert caught.value.lines[0].startswith("study: not valid TOML: ")
    assert caught.value.lines[0].endswith(remedy)


def test_a_whole_number_in_quotes_is_no_whole_number():
    with pytest.raises(InputError, match="must be a whole number, without quotes"):
        study_from_text(changed("samples = 100", 'samples = "100"'))


def test_a_parameter_on_the_command_line_may_have_its_unit(uq):
    given = ("simulate", "exponential-wear", "--json", "--set")
    assert uq(*given, "depth=2 mm").out == uq(*given, "depth=0.002").out
    assert "'kg' does not fit 'depth'" in uq(*given, "depth=2 kg").err


@pytest.mark.parametrize(
    ("old", "new", "meant"),
    [
        ('"lognormal"', '"gauss"', "did you mean 'normal'?"),
        ('"lognormal"', '"Gaussian"', "did you mean 'normal'?"),
        ("[analysis]", "[analysis]\ntolerance = {coverage = 95, confidence = 0.95}", "mean 0.95?"),
        ("[analysis]", "[analysis]\nquantiles = [5]", "did you mean 0.05?"),
    ],
)
def test_a_probable_mistake_is_answered_with_what_is_meant(old, new, meant):
    with pytest.raises(InputError) as caught:
        study_from_text(changed(old, new))
    assert meant in str(caught.value)


def test_the_beginning_of_a_name_is_answered_with_the_name():
    text = TEXT.replace("exponential-wear", "beam").replace("uncertain.rate", "uncertain.force")
    with pytest.raises(InputError, match="did you mean 'force_amplitude'?"):
        study_from_text(text)


def test_a_percentage_for_a_coefficient_of_variation_is_pointed_out():
    assert not any("cv" in hint for hint in hints(study_from_text(TEXT)))
    (hint,) = (hint for hint in hints(study_from_text(changed('"15 %"', "15"))) if "cv" in hint)
    assert "if 15 % is meant, write cv = 0.15" in hint
