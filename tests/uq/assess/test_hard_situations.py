"""Situations in which programs of this kind have failed, each with its right answer."""

from dataclasses import replace

import numpy as np
import pytest
from asked_indices import sensitivities, values
from computed import (
    UNIFORM,
    asking,
    computed,
    linear,
    study_of,
    summarised,
    with_output,
)
from learnt_studies import lognormal
from limit_states import SPHERE, STANDARD
from own_machines import opened
from own_study import own_study
from rare_studies import close, study
from rare_studies import linear as rare_linear
from sample_models import SIDES, ok, simple

import uq as package
from uq.assess.effects import effects
from uq.assess.summary import summarise
from uq.contract import Output
from uq.errors import InputError
from uq.explore.rare_events import rare_event
from uq.explore.updating import update
from uq.learning.answer import learnt
from uq.result.result import Result
from uq.stats.dependent_rows import Dependence
from uq.stats.order_statistics import rows_for_bound

FAR = 1e12
"""Doubles are 1.2e-4 apart here."""

NUMPY_SEED = """
import numpy as np, uq
@uq.machine(returns={"y": "1"})
def noise(seed, x1: float = 0.0):
    return {"y": np.random.RandomState(seed).normal()}
"""

DRAW = """
[machine]
name = "draw"
command = ["awk", "BEGIN {x1 = {x1}; srand({seed}); print \\"y = \\" rand()}"]
[parameters.x1]
nominal = 0.0
[outputs.y]
pattern = 'y = (\\S+)'
"""


def of_values(z, kind="value", censored=None, **analysis):
    ds = with_output(linear(samples=len(z)), "z", z, kind, censored)
    return asking(ds, outputs=["z"], **analysis)


@pytest.mark.parametrize("value", [192.53, 0.1 + 0.2, -1e300, 0.0])
def test_a_constant_scatters_by_nothing(value):
    ds = of_values(np.full(1000, value))
    described = summarised(ds)["outputs"]["z"]
    assert described["mean"] == value and described["sd"] == 0.0
    assert {entry["value"] for entry in described["quantiles"].values()} == {value}


@pytest.mark.parametrize("method", ["delta", "pawn", "rbd-fast", "hdmr", "first-order"])
def test_what_varies_by_rounding_alone_depends_on_nothing(method):
    x = linear(samples=1000)["x1"].values
    nearly = (192.53 + x) - x
    assert np.ptp(nearly) > 0
    (entry,) = sensitivities(of_values(nearly), method=method)["outputs"].values()
    assert "the same value in all rows" in entry["refused"]


def _two(x, seed, settings):
    return {"y": np.stack([x[:, 0] + 2 * x[:, 1], np.full(len(x), 3.0)], axis=1)}, ok(len(x))


TWO = simple(
    "two",
    _two,
    outputs={"y": Output("1", "y", dims=("side",))},
    coordinates=lambda settings: {"side": SIDES},
)


@pytest.mark.parametrize("method", ["saltelli", "monte-carlo", "shapley"])
def test_an_element_that_never_varies_leaves_the_others_their_indices(method):
    tables = {
        "study": {"name": "two", "model": "linear"},
        "design": {"method": method, "samples": 256},
        "uncertain": {"x1": UNIFORM, "x2": UNIFORM},
    }
    entries = sensitivities(computed(study_of(tables, "test_hard_situations:TWO")))["outputs"]
    assert "the same value" in entries["y[side=right]"]["refused"]
    for name in ("y[side=left]", "y[:]"):
        kind = "shapley" if method == "shapley" else "S1"
        assert values(entries[name], kind) == pytest.approx([0.2, 0.8], abs=0.03)


def test_an_output_far_from_zero_shows_the_digits_that_tell_rows_apart():
    far = FAR + linear(samples=500)["y"].values
    ds = of_values(far, tolerance={"coverage": 0.95, "confidence": 0.95})
    assert summarised(ds)["outputs"]["z"]["sd"] == pytest.approx(np.std(far - FAR, ddof=1))
    for statistic in summarise(Result(ds)).outputs["z"].statistics:
        if statistic.key[0] in ("mean", "quantiles", "tolerance"):
            assert float(statistic.words()) == pytest.approx(statistic.estimate.value, abs=0.06)
            assert len(set(statistic.interval().split(" to "))) == 2 - (
                not statistic.estimate.has_interval
            )
    likely = package.answer(ds).lead.range
    for end in (likely.low, likely.high):
        shown = float(likely.unit.number(end.value)) * likely.unit.per
        assert shown == pytest.approx(end.value, abs=0.06)


@pytest.mark.parametrize("size", [2.0**990, 2.0**-600])
def test_squares_that_overflow_or_vanish_change_no_number(size):
    plain = linear(samples=200)
    ds = of_values(size * plain["y"].values)
    np.testing.assert_array_equal(package.levels(ds, "z")["share"], package.levels(plain)["share"])
    change = {"uncertain.x1.upper": 0.9}
    sd, expected = (package.what_if(result, change)["sd"].item() for result in (ds, plain))
    assert sd == size * expected
    screened = linear(method="morris", samples=20)
    large = with_output(screened, "z", size * screened["y"].values)
    entry, expected = (
        sensitivities(result, output=name)["outputs"][name]
        for result, name in ((large, "z"), (screened, "y"))
    )
    for kind in ("mu", "sigma"):
        assert values(entry, kind) == [size * value for value in values(expected, kind)]
    replicated = linear(method="latin-hypercube", samples=32, replicates=4)
    inputs = {name: replicated[name].values for name in ("x1", "x2", "x3", "x4")}
    replicates = Dependence(replicated["replicate"].values)
    slope, expected = (
        effects(factor * replicated["y"].values, inputs, replicates)["x1"].slope
        for factor in (size, 1.0)
    )
    assert (slope.low, slope.high) == (size * expected.low, size * expected.high)
    for form in (np.asarray, np.exp):  # the intervals of a mean, of a skewed one too
        x = form(3 * replicated["x1"].values)
        ends, scaled = (
            summarised(asking(with_output(replicated, "z", factor * x), outputs=["z"]))
            for factor in (1.0, size)
        )
        ends, scaled = (each["outputs"]["z"]["mean_interval"] for each in (ends, scaled))
        assert [scaled[end] for end in ("low", "high")] == [
            size * ends[end] for end in ("low", "high")
        ]


def test_ends_and_censoring_that_are_tied():
    lives = np.repeat([2.0, 8.0, 9.0, 20.0, 20.0], [1, 9, 5, 10, 75])
    ds = of_values(
        lives,
        "lifetime",
        np.arange(100) >= 25,
        thresholds={"z": [8.0, 9.0, 20.0]},
        quantiles=[0.05],
    )
    described = summarised(ds)["outputs"]["z"]
    below = [entry["below"]["value"] for entry in described["thresholds"].values()]
    above = [entry["above"]["value"] for entry in described["thresholds"].values()]
    assert below == pytest.approx([0.01, 0.1, 0.15]) and above == pytest.approx([0.9, 0.85, 0.75])
    assert described["b_lives"]["B10"]["value"] == pytest.approx(8 + 11 / 30)
    assert described["quantiles"]["0.05"]["value"] == 8.0


def test_few_ends_and_all_others_censored_at_one_time():
    lives = np.concatenate([np.arange(1.0, 6.0), np.full(100, 6.0)])
    ds = of_values(lives, "lifetime", lives == 6.0)
    described = summarised(ds)["outputs"]["z"]
    assert described["mean"] is None and described["sd"] is None
    assert described["b_lives"]["B1"]["value"] == pytest.approx(1 + 29 / 75)
    assert described["b_lives"]["B50"]["value"] is None
    curve = package.survival(ds, "z").sel(time=5.0, method="ffill")
    assert float(curve["survival"]) == pytest.approx(100 / 105)


def test_probabilities_with_failed_rows():
    ds = of_values(np.repeat([2.0, np.nan, 0.0], [10, 6, 184]), thresholds={"z": [1.0]})
    ds["status"][10:16] = 2
    above = summarised(ds)["outputs"]["z"]["thresholds"]["1.0"]["above"]
    expected = {
        "value": 10 / 194,
        "low": 0.02499205,
        "high": 0.09275068,
        "failed_low": 0.02423417,
        "failed_high": 0.12666486,
    }
    assert {key: above[key] for key in expected} == pytest.approx(expected, rel=1e-6)


def test_rows_needed_for_a_tolerance_bound():
    needed = [rows_for_bound(0.95, 0.95, failed) for failed in range(5)]
    assert needed == [59, 93, 124, 153, 181]
    by_confidence = [rows_for_bound(0.95, c) for c in np.linspace(0.5, 0.999, 200)]
    assert by_confidence == sorted(by_confidence)


def test_the_seed_of_a_program_fits_into_its_integers(uq, folder):
    (folder / "draw.toml").write_text(DRAW)
    (folder / "own.toml").write_text(own_study("draw"))
    uq("run", "own.toml", "--model", "draw.toml", "-o", "own.nc", "--quiet")
    assert len(np.unique(opened()["y"].values)) == 20


def test_a_seed_too_long_for_a_generator_is_said_so(uq, write_function):
    name = write_function(NUMPY_SEED, own_study("noise"))
    ended = uq("run", "own.toml", "--model", name, "-o", "own.nc", "--quiet")
    assert "the seed of a row has 64 bits: shorten it to seed % 2**32" in ended.err


def test_a_certain_event_has_no_design_point():
    with pytest.raises(InputError, match="all of 1000 rows are beyond the threshold"):
        rare_event(rare_linear(), "y", -1.0, method="importance", workers=0)
    certain = rare_event(rare_linear(), "y", -1.0, workers=0, replicates=2)
    assert float(certain["probability"]) == float(certain["high"]) == 1.0


def _pair(x, seed, settings):
    return {"pair": x[:, 0] + x[:, 1]}, ok(len(x))


PAIR = replace(SPHERE, name="pair", outputs={"pair": Output("1", "sum of two")}, batch=_pair)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["subset", "importance"])
@pytest.mark.parametrize("inputs", [2, 8])
def test_inputs_that_are_not_used_do_not_mislead_a_search(method, inputs):
    names = [f"x{i + 1}" for i in range(inputs)]
    of = study("test_hard_situations:PAIR", dict.fromkeys(names, STANDARD))
    ds = rare_event(of, "pair", 4.7 * np.sqrt(2), method=method, workers=0)
    assert close(ds, 1.300807454e-06)


@pytest.mark.slow
def test_a_life_within_an_interval_and_a_line_at_its_beginning():
    laws = {"rate": lognormal(2.5e-10, 0.5, "shared"), "depth": lognormal(2.5e-4, 0.1)}
    rows = computed(
        study_of(
            {
                "study": {"name": "wear", "model": "exponential-wear"},
                "design": {"method": "monte-carlo", "samples": 4000, "units": 2, "seed": 1},
                "uncertain": laws,
            }
        )
    )
    line = {"unit": "A", "output": "life"}
    within = [
        line | {"kind": "survived", "time": 432000.0},
        line | {"kind": "ended", "time": 864000.0},
    ]
    answers = [
        learnt(update(rows, [*within, *more]))
        for more in ([], [line | {"kind": "survived", "time": 0.0}])
    ]
    for answer in answers:
        rate = next(entry.posterior for entry in answer.inputs if entry.name == "rate")
        assert rate.mean.value == pytest.approx(3.836346593e-10, rel=0.02)
        assert rate.sd.value == pytest.approx(8.10448196e-11, rel=0.06)
        assert rate.quantiles[0.5] == pytest.approx(3.686359093e-10, rel=0.02)
    assert answers[0].inputs == answers[1].inputs
    assert answers[1].taught[-1].bits == 0.0
