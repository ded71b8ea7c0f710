"""A negative life is none: its row fails with a sentence. A life of zero is one."""

import numpy as np
import pytest
from computed import study_of
from own_machines import PAD, opened, run_program
from own_study import own_study

from uq.contract import Status
from uq.errors import InputError

LATE = """
import uq

@uq.machine(returns={"life": uq.Returned("s", life=True)})
def late(stop: float = 5.0):
    return {"life": %s}
"""
STUDY = own_study("late", "stop", lower=1.5, upper=10.0, samples=200)


def run(uq, write_function, life):
    name = write_function(LATE % life, STUDY)
    ended = uq("run", "own.toml", "--model", name, "-o", "own.nc", "--quiet")
    return ended, opened()


@pytest.mark.parametrize("life", ["stop - 2.0", "uq.censored(stop - 2.0)"])
def test_a_negative_life_is_a_failed_row(uq, write_function, life):
    _, ds = run(uq, write_function, life)
    negative = ds["stop"].values < 2.0
    assert negative.any()
    assert (ds["status"].values == np.where(negative, Status.NON_FINITE, Status.OK)).all()
    assert np.isnan(ds["life"].values[negative]).all()
    assert "a life cannot be negative" in ds["status"].attrs["example_non_finite"]


def test_zero_is_a_life(uq, write_function, no_other_figures):
    _, ds = run(uq, write_function, "max(stop - 2.0, 0.0)")
    assert (ds["status"] == Status.OK).all() and (ds["life"] == 0).any()
    for verb in ("summary", "sensitivity", "report"):
        ended = uq(verb, "own.nc")
        assert ended.code == 0 and "nan" not in ended.out


def test_a_negative_life_of_a_program_is_a_failed_row(uq, write_program):
    script = "#!/bin/sh\necho 'life = -0.5'\n"
    text = PAD[: PAD.index("[outputs.pair]")]
    write_program(script, text)
    _, ds = run_program(uq)
    assert "a life cannot be negative" in ds["status"].attrs["example_non_finite"]


@pytest.mark.parametrize(("threshold", "fits"), [("-4 days", False), (-1.0, False), ("0 s", True)])
def test_no_life_is_compared_with_a_time_before_its_start(threshold, fits):
    tables = wear() | {"analysis": {"thresholds": {"life": threshold}}}
    if fits:
        assert study_of(tables).analysis.thresholds["life"] == (0.0,)
        return
    with pytest.raises(InputError, match="is before the start of the life"):
        study_of(tables)


def wear():
    rate = {"distribution": "lognormal", "median": 2e-10, "sigma": 0.5}
    return {
        "study": {"name": "wear", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 20},
        "uncertain": {"rate": rate},
    }


def test_an_angle_is_not_compared_with_more_than_half_a_turn():
    tables = wear() | {"analysis": {"thresholds": {"disphasing_angle": 12}}}
    tables["study"] = {"name": "screen", "model": "vibrator"}
    tables["uncertain"] = {"rated_torque_1": {"distribution": "normal", "mean": 50.0, "sd": 1.0}}
    with pytest.raises(InputError, match="more than half a turn .* write '12 degrees'"):
        study_of(tables)
