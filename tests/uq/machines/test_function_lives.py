"""A plain function as a machine: lives, units and scales, declared or found from rows."""

import pytest
from computed import summarised
from own_machines import WEAR, WEAR_STUDY

import uq as package
from uq.contract import Status


def test_a_life_that_ends_in_all_rows_seen_is_named_when_one_does_not(uq, write_function):
    study = WEAR_STUDY.replace("samples = 100", "samples = 1000").replace(
        "lower = 0.0", "lower = 0.2"
    )
    file = write_function(WEAR.replace("load < 0.1", "0.900 < load < 0.903"), study)
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet")
    ds = package.open_result("own.nc")
    lost = ds["status"].values == Status.BAD_SHAPE
    assert lost.any() and not lost[:64].any()
    assert "returns={'life': uq.Returned(life=True)}" in ds["status"].attrs["example_bad_shape"]


def test_what_is_declared_is_not_looked_for(uq, write_function):
    text = WEAR.replace(
        "@uq.machine", '@uq.machine(returns={"life": uq.Returned("s", life=True), "profile": "m"})'
    )
    ended = uq("check", "own.toml", "--model", write_function(text))
    assert ended.code == 0
    uq("run", "own.toml", "--model", write_function(text), "-o", "own.nc", "--quiet")
    ds = package.open_result("own.nc")
    assert ds["life"].attrs["units"] == "s"
    sentence = ds["status"].attrs["example_bad_shape"]
    assert "returned 'profile' with shape (2,), expected ()" in sentence


@pytest.mark.parametrize(
    ("unit", "says"), [("m", ""), ("mm", ""), ("MPa", "'um' does not fit 'y' (allowed: MPa, Pa,")]
)
def test_a_threshold_has_a_unit_that_fits_its_output(uq, write_function, unit, says):
    text = f"import uq\n@uq.machine(returns={{'y': '{unit}'}})\ndef wear(load=1.0): ...\n"
    study = WEAR_STUDY + "[analysis]\nthresholds = {y = '250 um'}\n"
    ended = uq("check", "own.toml", "--model", write_function(text, study))
    assert (ended.code == 0) is not says and says in ended.err


def test_a_life_in_hours_is_asked_for_in_hours_or_days(uq, write_function):
    text = (
        "import uq\n@uq.machine(returns={'life': uq.Returned('h', life=True)})\n"
        "def wear(load=1.0):\n    return {'life': 3000 / load}\n"
    )
    tables = (
        "[analysis]\nthresholds = {life = ['2000 hours', '100 days']}\n"
        "[design.until]\noutput = 'life'\nb_life = 'B50'\nhalf_width = '6 days'\n"
    )
    model = write_function(text, WEAR_STUDY + tables)
    ended = uq("run", "own.toml", "--model", model, "-o", "own.nc")
    assert ended.code == 0, ended.err
    ds = package.open_result("own.nc")
    asked = package.summary(ds)
    shares = [float((ds["life"] < t).mean()) for t in (2000.0, 2400.0)]
    assert [asked.loc["life", f"P(<{t})"] for t in (2000.0, 2400.0)] == pytest.approx(shares)
    full = uq("summary", "own.nc", "--full").out
    assert "P(> 2000 hours)" in full and "P(< 100 days)" in full
    assert "P(life < 100 days)" in uq("sensitivity", "own.nc", "--output", "P(life < 2400 h)").out
    wrong = uq("sensitivity", "own.nc", "--output", "P(life < 50 days)")
    assert "no such event 'P(life<1200.0)'" in wrong.err


def test_a_threshold_with_a_unit_waits_for_the_outputs(uq, write_function):
    limits = '[analysis]\nthresholds = {life = "4 days"}\n'
    refused = uq("check", "own.toml", "--model", write_function(WEAR, WEAR_STUDY + limits))
    assert refused.code == 2 and "the unit 'days' does not fit 'life'" in refused.err
    assert "returns={'life': uq.Returned('s', life=True), ...}" in refused.err
    in_seconds = '@uq.machine(returns={"life": uq.Returned("s", life=True), "profile": "m"})'
    text = WEAR.replace("@uq.machine", in_seconds)
    assert uq("check", "own.toml", "--model", write_function(text, WEAR_STUDY + limits)).code == 0


def test_a_life_is_counted_in_its_own_unit(uq, write_function):
    text = WEAR.replace(
        "@uq.machine",
        '@uq.machine(returns={"life": uq.Returned("cycles", life=True), "profile": uq.Returned('
        "shape=(2,))})",
    )
    uq(
        "run",
        "own.toml",
        "--model",
        write_function(text),
        "-o",
        "own.nc",
        "--quiet",
        "--samples",
        "40",
    )
    ds = package.open_result("own.nc")
    assert package.survival(ds, "life")["time"].attrs["units"] == "cycles"
    ended = uq("fleet", "own.nc", "--size", "1", "--by", "2")
    assert "life [cycles]" in ended.out and "by 2 cycles" in ended.out
    assert "the unit 'h' does not fit" in uq("fleet", "own.nc", "--size", "1", "--by", "2 h").err


SCALED = """
import math
import uq

@uq.machine(returns={"life": uq.Returned("s", life=True, scales={"load": -1.0, "depth": 2.0})})
def wear(load: float = 1.0, depth: float = 3.0, hard: float = 1.0):
    if hard > 1.5:
        return {"life": math.inf}
    life = hard * depth**2 / load
    return {"life": life if life < 20.0 else uq.censored(20.0)}
"""
SCALES_STUDY = (
    WEAR_STUDY.replace("lower = 0.0", "lower = 1.0")
    + """
[uncertain.hard]
distribution = "uniform"
lower = 0.2
upper = 0.9
source = "assumed"
[analysis]
thresholds = {life = 4.0}
"""
)


def test_what_only_scales_a_life_is_integrated(uq, write_function):
    file = write_function(SCALED, SCALES_STUDY)
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet")
    assert "load integrated exactly, worth" in uq("summary", "own.nc", "--explain", "--full").out
    ds = package.open_result("own.nc")
    by = summarised(ds)["outputs"]["life"]["thresholds"]["4.0"]["below"]["value"]
    hard = ds["hard"].values
    assert by == pytest.approx((2.0 - 9.0 * hard / 4.0).clip(0, 1).mean(), rel=1e-12)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (("/ load", "/ (load + 1e-6)"), "'life' does not scale as declared: at load = "),
        (("hard > 1.5", "load > 1.5"), "not inf|it is inf, not"),
        (("/ load", "/ min(load, 1.9)"), "'life' does not scale as declared: at load = 2"),
        (("/ load", "/ (load if hard < 0.85 else 1.0)"), "'life' does not scale as declared"),
        (("/ load", "/ (load if hard > 0.25 else 1.0)"), "'life' does not scale as declared"),
        (("censored(20.0)", "censored(1e9)"), "it is 1e+09, not"),
        (('"depth": 2.0', '"dept": 2.0'), "scales: no such parameter; did you mean 'depth'?"),
        (('"depth": 2.0', '"depth": 0.0'), "depth = 0.0 must be a number but 0"),
        (("life=True, ", ""), "only a life has scales"),
        (("depth: float = 3.0", "depth: float = -3.0"), "value of 'depth' must be positive"),
    ],
)
def test_a_life_that_does_not_scale_as_declared_is_refused(uq, write_function, wrong, message):
    file = write_function(SCALED.replace(*wrong), SCALES_STUDY)
    for verb in (("check", "own.toml"), ("run", "own.toml", "-o", "own.nc", "--quiet")):
        ended = uq(*verb, "--model", file)
        assert ended.code == 2 and any(words in ended.err for words in message.split("|")), (
            ended.err
        )
