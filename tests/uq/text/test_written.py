"""Numbers written with their unit: in study files, on the command line, and back in tables."""

import json
import pickle

import numpy as np
import pytest
from computed import asking, linear, study_of, summarised, with_output

from uq.errors import InputError
from uq.files.whole_files import write_result
from uq.text.numbers import threshold
from uq.text.quantities import fault_of_unit, misfit, read_quantity, read_threshold


@pytest.mark.parametrize(
    ("text", "value", "shown"),
    [
        ("24 h", 86400.0, "hours"),
        ("24 hours", 86400.0, "hours"),
        ("1day", 86400.0, "days"),
        ("0.01 years", 315576.0, "years"),
        ("90 min", 5400.0, "minutes"),
        ("12 degrees", 0.20943951023931953, "°"),
        ("2°", 0.03490658503988659, "°"),
        ("250 um", 2.5e-4, "µm"),
        ("250 µm", 2.5e-4, "µm"),
        ("0.3 mm", 3e-4, "mm"),
        ("30 mm/s", 0.03, "mm s-1"),
        ("30 mm s-1", 0.03, "mm s-1"),
        ("30 mm s⁻¹", 0.03, "mm s-1"),
        ("1.375e1 kN m-1", 13750.0, "kN m-1"),
        ("5 %", 0.05, "%"),
        ("3 furlongs", 3.0, "furlongs"),
    ],
)
def test_a_quantity_is_the_number_that_one_would_write_in_the_plain_unit(text, value, shown):
    quantity = read_quantity(text)
    assert quantity == value and repr(quantity) == repr(value)
    assert quantity.unit.name == shown and quantity / quantity.unit.size == pytest.approx(
        float(quantity.number)
    )
    again = pickle.loads(pickle.dumps(quantity))
    assert (again, again.unit, again.number) == (quantity, quantity.unit, quantity.number)


@pytest.mark.parametrize(
    "text", ["", "24", "hours", "10e5", "1/2 h", "nan h", "1e999 h", "24 h ours?" * 9, "- 3 m"]
)
def test_what_is_no_quantity_is_refused(text):
    with pytest.raises(ValueError, match="number"):
        read_quantity(text)


@pytest.mark.parametrize(
    ("text", "units", "words"),
    [
        ("250 um^0.5", "m", "; powers are whole numbers, as in 'm s-2' or 'm/s^2' (allowed: m,"),
        ("250 um^1/2", "m", "; powers are whole numbers"),
        ("3 m**0.5", "m", "; powers are whole numbers"),
        ("3 kg0.5", "kg", "; powers are whole numbers"),
        ("250 microns", "m", "; did you mean 'um'? (allowed: m, mm, um, km)"),
        ("250 mikrons", "m", "; did you mean 'um'?"),
        ("250 pm/sec", "m s-1", "; did you mean 'pm/s'?"),
        ("250 pm.s-1", "m s-1", "; did you mean 'pm s-1'?"),
        ("250 pm/(s)", "m s-1", "; did you mean 'pm/s'?"),
        ("4 weeks", "s", "; did you mean 'days'?"),
        ("4 micronewtons", "m", "' does not fit 'x' (allowed:"),
    ],
)
def test_a_misspelt_unit_or_power_comes_with_the_right_one(text, units, words):
    assert words in misfit(text, "x", units)


def test_the_unit_of_an_own_machine_has_whole_powers():
    assert fault_of_unit("kg0.5").startswith("powers are whole numbers")
    assert fault_of_unit("kg m2 s-2") == ""


def test_a_unit_that_does_not_fit_names_those_that_do():
    assert misfit("24 hours", "life", "s") == "" == misfit("3 Ω", "r", "ohm")
    assert misfit("24 hurs", "life", "s") == (
        "the unit 'hurs' does not fit 'life'; did you mean 'hours'?"
        " (allowed: s, minutes, hours, days, years, ms)"
    )
    assert "(allowed: rad, degrees)" in misfit("12 mm", "angle", "rad")
    assert "(allowed: m s-1, mm s-1, um s-1, km s-1)" in misfit("12 mm", "rate", "m s-1")


@pytest.mark.parametrize(
    ("text", "units", "value"),
    [
        ("2000 hours", "h", 2000.0),
        ("1 hour", "h", 1.0),
        ("90 days", "h", 2160.0),
        ("30 minutes", "h", 0.5),
        ("1 year", "d", 365.25),
        ("7200 seconds", "h", 2.0),
        ("250 um", "mm", 0.25),
        ("3 mm/s", "mm h-1", 10800.0),
        ("12 degrees", "degrees", 12.0),
        ("3 cycles", "cycles", 3.0),
    ],
)
def test_a_quantity_is_converted_to_the_unit_of_its_output(text, units, value):
    assert misfit(text, "y", units) == ""
    assert read_quantity(text, units) == read_threshold("--by", text, "y", units) == value
    assert threshold(read_quantity(text, units), units) == threshold(read_quantity(text), "")


def test_a_unit_that_does_not_fit_a_unit_with_a_prefix_names_those_that_do():
    allowed = "(allowed: s, minutes, hours, days, years, ms)"
    assert misfit("3 kg", "life", "h") == f"the unit 'kg' does not fit 'life' {allowed}"
    assert "(allowed: mm h-1, m h-1, um h-1, km h-1)" in misfit("3 kg", "rate", "mm h-1")
    assert misfit("1e300 km", "y", "nm") == "is too large a number"
    assert misfit("3 kg", "y", "d99 " * 100_000)


def test_an_option_takes_plain_numbers_and_quantities():
    assert read_threshold("--by", "3600", "a life", "s") == 3600.0
    assert read_threshold("--by", "1 h", "a life", "s") == 3600.0
    with pytest.raises(InputError, match=r"--by 3 kg: the unit 'kg' does not fit 'a life'"):
        read_threshold("--by", "3 kg", "a life", "s")
    with pytest.raises(InputError, match="--by soon: must be a number, or have"):
        read_threshold("--by", "soon", "a life", "s")


def wear(thresholds):
    tables = {
        "study": {"name": "wear", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 64, "seed": 1},
        "uncertain": {"rate": {"distribution": "lognormal", "median": 2.5e-10, "sigma": 0.5}},
        "analysis": {"thresholds": {"life": thresholds}},
    }
    return study_of(tables)


@pytest.mark.parametrize(
    ("value", "units", "text"),
    [
        (1000000.0005, "1", "1000000.0005"),
        (1e6, "1", "1000000"),
        (86400.0, "s", "24 hours"),
        (1e6, "s", "1000000 s"),
        (86400.5, "s", "86400.5 s"),
        (0.4, "rad", "0.4 rad"),
        (np.pi / 15, "rad", "12°"),
        (0.00025, "m", "250 µm"),
    ],
)
def test_two_thresholds_never_read_alike(value, units, text):
    assert threshold(value, units) == text


def test_a_threshold_gives_the_same_numbers_however_it_is_written():
    plain, written = wear(864000.0), wear("10 days")
    assert plain.identity == written.identity
    assert plain.analysis.thresholds == written.analysis.thresholds
    assert wear([1.0, "1 h"]).analysis.thresholds["life"] == (1.0, 3600.0)
    ds = linear(samples=64)
    summaries = [
        summarised(asking(ds, thresholds={"y": threshold_text})) for threshold_text in (0.05, "5 %")
    ]
    assert summaries[0]["outputs"] == summaries[1]["outputs"]
    assert "0.05" in summaries[0]["outputs"]["y"]["thresholds"]


@pytest.mark.parametrize(
    ("thresholds", "line"),
    [
        ("10 kg", "life = \"10 kg\": the unit 'kg' does not fit 'life'"),
        (["1 h", "2 mm"], 'life = "2 mm": the unit'),
        (
            "soon",
            'thresholds.life = "soon": must be a number or a list of numbers, or have its unit',
        ),
        (True, "thresholds.life = true: must be a number or a list of numbers"),
        (["soon"], 'life[0] = "soon": must be a number, or have its unit: "24 hours", "250 um"'),
        (["1 h", 3600.0], "3600.0 is listed twice"),
    ],
)
def test_a_threshold_that_means_nothing_is_one_line(thresholds, line):
    with pytest.raises(InputError) as refused:
        wear(thresholds)
    (only,) = refused.value.lines
    assert line in only and "[analysis] thresholds.life" in only


def test_until_may_have_a_unit(uq, folder):
    tables = {
        "study": {"name": "wear", "model": "exponential-wear"},
        "uncertain": {"rate": {"distribution": "lognormal", "median": 2.5e-10, "sigma": 0.5}},
    }
    until = {"output": "life", "half_width": 0.1}
    design = {"method": "monte-carlo", "samples": 64}
    study = study_of(tables | {"design": design | {"until": until | {"below": "10 days"}}})
    assert study.design.until.estimate == "P(<864000.0)"
    with pytest.raises(InputError, match=r"\[design\] until.below = \"1 m\": the unit 'm'"):
        study_of(tables | {"design": design | {"until": until | {"below": "1 m"}}})


def test_the_unit_of_the_study_is_that_of_tables_and_json_stays_plain(uq, folder):
    ds = with_output(linear(samples=64), "life", 3600.0 * np.linspace(5, 15, 64), "lifetime")
    ds = asking(ds, outputs=["life"], thresholds={"life": "600 minutes"})
    write_result(ds, folder / "out.nc")
    shown = uq("summary", "out.nc", "--explain", "--full").out
    assert "P(< 600 minutes)" in shown and "fail within 600 minutes" in shown
    assert list(
        json.loads(uq("summary", "out.nc", "--json").out)["outputs"]["life"]["thresholds"]
    ) == ["36000.0"]
    ended = uq("sensitivity", "out.nc", "--output", "P(life < 600 minutes)", "--json")
    assert list(json.loads(ended.out)["outputs"]) == ["P(life<36000.0)"]
    for verb in ("sensitivity", "convergence"):
        assert "600 minutes" in uq(verb, "out.nc").out
