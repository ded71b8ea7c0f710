"""Every method over every kind of damage: the right answer, or a sentence that says why not."""

import json

import numpy as np
import pytest
from computed import asking, linear, with_output

import uq
from uq.designs import DESIGNS
from uq.errors import InputError
from uq.indices import sensitivities
from uq.statistics import summarise

DRAWN = [name for name, design in DESIGNS.items() if getattr(design, "draw", None) is not None]
FIRST = {method: name for name in reversed(DRAWN) for method in DESIGNS[name].feeds}
FED = sorted({(design, method) for method, design in FIRST.items()}) + [
    (name, DESIGNS[name].feeds[0]) for name in DRAWN if name not in FIRST.values()
]
"""Each method with the first design that feeds it, and each other design with its own method."""

ROWS = {"hdmr": 1024, "quantile": 512}
"""Other methods have enough in 128 samples."""


def result(design, samples=256):
    """Return y = x1 + 2 x2 + 3 x3 + 4 x4, a life, a constant, and a regime that x4 decides."""
    ds = linear(design, samples=samples, replicates=4 if DESIGNS[design].crossed else 1)
    y = ds["y"].values
    ds = with_output(ds, "flat", np.full(len(y), 0.1))
    ds = with_output(ds, "life", 1 / y, "lifetime")
    attrs = {
        "role": "output",
        "kind": "category",
        "units": "1",
        "long_name": "which regime",
        "may_be_undefined": 0,
        "flag_values": np.array([-1, 0, 1], np.int8),
        "flag_meanings": "none low high",
    }
    ds = ds.assign(regime=("sample", (ds["x4"].values > 0.5).astype(np.int8), attrs))
    return asking(ds, thresholds={"life": 0.2})


def damaged(ds, how):
    outputs = ("y", "flat", "life")
    ds = ds.copy(deep=True)
    if how == "one failed row":
        for name in outputs:
            ds[name][5] = np.nan
        ds["regime"][5] = -1
        ds["status"][5] = 2
    elif how == "one infinite life":
        ds["life"][5] = np.inf
    elif how == "all failed":
        for name in outputs:
            ds[name][:] = np.nan
        ds["regime"][:] = -1
        ds["status"][:] = 2
    elif how == "interrupted":
        ds = ds.isel(sample=slice(None, ds.sizes["sample"] - 7))
    return ds


DAMAGES = ["none", "one failed row", "one infinite life", "all failed", "interrupted"]


def strict(found):
    """Return what is printed as JSON; a number that is not finite is a mistake."""
    return json.loads(json.dumps(found, allow_nan=False))


@pytest.mark.parametrize("damage", DAMAGES[1:])
@pytest.mark.parametrize(("design", "method"), FED)
def test_sensitivity(design, method, damage):
    ds = damaged(result(design, ROWS.get(method, 128)), damage)
    try:
        outputs = strict(sensitivities(ds, method))["outputs"]
    except InputError as refusal:
        assert damage == "interrupted" and "missing" in str(refusal)
        return
    if damage == "all failed":
        assert outputs or method == "regional"
        assert all(entry["refused"] for entry in outputs.values())
        return
    assert "flat" not in outputs or outputs["flat"]["refused"]
    answered = {name: entry for name, entry in outputs.items() if "refused" not in entry}
    assert answered
    for name, entry in answered.items():
        for kind, indices in entry.items():
            if kind in ("S1", "ST", "delta", "pawn", "KS", "Q0.5", "B10", "shapley"):
                found = {label: index["value"] for label, index in indices.items()}
                assert found["x4"] > found["x1"], (name, kind, found)
                assert -0.3 < min(found.values()) and max(found.values()) < 1.3
    refused = {name: entry["refused"] for name, entry in outputs.items() if "refused" in entry}
    assert all(len(sentence) > 20 for sentence in refused.values())


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("design", DRAWN)
def test_summary_survival_fits_and_regimes(design, damage):
    ds = damaged(result(design), damage)
    found = strict(summarise(ds, fits=True))
    y, life, flat = (found["outputs"][name] for name in ("y", "life", "flat"))
    curve = uq.survival(ds, "life")
    compared = uq.regimes(ds)
    if damage == "all failed":
        assert y["mean"] is flat["mean"] is life["b_lives"]["B10"]["value"] is None
        assert y["failed"] == found["rows_used"] == life["failed"]
        assert all(fit["refused"] for fit in life["fits"].values())
        assert curve.sizes["time"] == 0 == compared.sizes["regime"]
        return
    assert flat["mean"] == pytest.approx(0.1)
    assert flat["mean_interval"] == {"low": None, "high": None}
    assert life["never"] == int(damage == "one infinite life")
    assert (life["mean"] is None) == (damage == "one infinite life")
    assert "between_regimes" not in flat
    # Of the variance 30/12, 16/12 is that of 4 x4, three quarters of it between its halves.
    if DESIGNS[design].crossed or design in ("monte-carlo", "latin-hypercube", "sobol", "halton"):
        assert y["mean"] == pytest.approx(5.0, abs=0.4)
        assert life["b_lives"]["B50"]["value"] == pytest.approx(0.2, rel=0.07)
        assert y["between_regimes"]["value"] == pytest.approx(0.4, abs=0.12)
        assert float(curve["survival"].sel(time=0.2, method="ffill")) == pytest.approx(0.5, abs=0.1)
        share = float(compared["share"].sel(regime="high"))
        assert share == pytest.approx(0.5, abs=0.1)
    # A bounded sum is neither law's rate; and with rows that never end none of the two is asked.
    for fit in life["fits"].values():
        assert ("never end" in fit.get("refused", "")) == (
            damage == "one infinite life" and design == "monte-carlo"
        )
        assert ("independent rows" in fit.get("refused", "")) == (design != "monte-carlo")
    if "distance" in compared:
        distance = compared["distance"].sel(regime="high")
        assert str(distance.idxmax("parameter").values) == "x4" and float(distance.max()) == 1.0
        assert float(distance.sel(parameter="x1")) < 0.35
