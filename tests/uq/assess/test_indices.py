"""Sensitivity indices: which method, of which outputs, in which form."""

import numpy as np
import pytest
from asked_indices import INPUTS, indices, ishigami, sensitivities
from computed import kinds, linear, with_output

import uq
from uq.assess.sensitivities import methods
from uq.contract import Status
from uq.errors import InputError
from uq.result.result import Result


def test_method_is_the_studys_or_the_designs_own():
    assert methods(Result(linear("saltelli"))) == ("sobol",)
    assert methods(Result(linear("halton", 128))) == ("first-order",)
    ds = linear(samples=128, analysis={"sensitivity": ["pawn", "delta"]})
    assert methods(Result(ds)) == ("pawn", "delta")
    assert sensitivities(ds)["method"] == "pawn"
    assert sensitivities(ds, "rbd-fast")["method"] == "rbd-fast"


@pytest.mark.parametrize(
    ("design", "method", "sentence"),
    [
        (
            "monte-carlo",
            "sobol",
            "needs a design of saltelli; this result is of design 'monte-carlo'",
        ),
        (
            "saltelli",
            "delta",
            "needs a design of monte-carlo or latin-hypercube or sobol or halton",
        ),
        ("monte-carlo", "pawm", "no such method 'pawm'; did you mean 'pawn'"),
    ],
)
def test_a_method_that_the_design_cannot_feed_is_refused(design, method, sentence):
    with pytest.raises(InputError, match=sentence):
        sensitivities(linear(design), method)


def test_outputs_can_be_named_in_every_way():
    ds = kinds(samples=128, analysis={"thresholds": {"life": 1.0}, "outputs": ["work"]})
    assert list(indices(ds)["outputs"])[:2] == ["work[side=left]", "work[side=right]"]
    assert list(indices(ds, output="angle")["outputs"]) == ["angle"]
    assert list(indices(ds, output="work[side=left]")["outputs"]) == ["work[side=left]"]
    assert len(indices(ds, output="life")["outputs"]) == 9
    assert list(indices(ds, output="life")["outputs"])[0] == "rank(life[side=left,depth=0.5])"
    name = "P(life[side=left,depth=0.5]<1.0)"
    assert list(indices(ds, output=name)["outputs"]) == [name]
    for form in ("log", "rank", "rate"):
        name = f"{form}(life[side=right,depth=1.5])"
        assert list(indices(ds, output=name)["outputs"]) == [name]
    name = "log(work[side=left])"
    assert list(indices(ds, output=name)["outputs"]) == [name]
    both = ["P(regime=slow)", "P(regime=fast)"]
    assert list(indices(ds, output="regime")["outputs"]) == both
    assert list(indices(ds, output=both[1])["outputs"]) == both[1:]
    for wrong, sentence in {
        "wrok": "no such output 'wrok'; did you mean 'work'",
        "work[side=lefd]": r"no such element 'work\[side=lefd\]'; did you mean 'work\[side=left\]'",
        "rate(work[side=left])": "no such output",
        "log(angle)": "no such output",
        "log(life)": "no such output",
        "rank(regime)": "no such output",
        "P(life[side=left,depth=0.5]<2.0)": r"no such event .*allowed: P\(life.*thresholds",
        "P(regime=medium)": "no such output",
    }.items():
        with pytest.raises(InputError, match=sentence):
            sensitivities(ds, output=wrong)


def test_indices_as_arrays_say_the_same():
    ds = ishigami(samples=64, replicates=4, second_order=True)
    arrays = uq.sensitivity(ds)
    entry = indices(ds)["outputs"]["y"]
    assert list(arrays["parameter"].values) == list(INPUTS)
    index = arrays.sel(output="y", parameter="x2")
    assert [float(index[name]) for name in ("ST", "ST_low", "ST_high")] == list(
        entry["ST"]["x2"].values()
    )
    assert float(arrays["S2_high"].sel(output="y", pair="x1,x3")) == entry["S2"]["x1,x3"]["high"]

    plain = with_output(linear(samples=128), "flat", np.full(128, 1.0))
    arrays = uq.sensitivity(plain, "rbd-fast")
    assert float(arrays["dummy_S1"].sel(output="y")) > 0
    assert np.isnan(arrays["S1"].sel(output="flat")).all()
    assert arrays["refused"].sel(output="y") == ""
    assert "same value" in arrays["refused"].sel(output="flat").item()


def test_all_failed_is_refused_everywhere():
    for design, chosen in (("saltelli", ["sobol"]), ("monte-carlo", ["rbd-fast", "delta", "pawn"])):
        ds = linear(design, samples=128, settings={"fail_above": -1.0})
        assert (ds["status"] == Status.NON_FINITE).all()
        for method in chosen:
            sensitivity_result = indices(ds, method)
            assert "refused" in sensitivity_result["outputs"]["y"]
            assert sensitivity_result["rows_used"] == 0
            assert np.isnan(uq.sensitivity(ds, method).get("S1", np.nan)).all()


def test_the_interval_of_a_share_holds_what_a_share_can_be():
    """One in forty or fewer inputs without effect has an index significantly below 0."""
    rng, ds, highs = np.random.default_rng(0), linear(samples=400), []
    for _ in range(60):
        event = with_output(ds, "event", (rng.random(400) < 0.1) * 1.0)
        of_inputs = sensitivities(event, "first-order", "event")["outputs"]["event"]["S1"]
        highs += [index["high"] for index in of_inputs.values()]
    assert min(highs) == 0.0
