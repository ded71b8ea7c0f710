"""Every method over every kind of damage: the right answer, or a sentence that says why not."""

import json
from functools import cache

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import (
    UNIFORM,
    asking,
    computed,
    linear,
    study_of,
    summarised,
    with_output,
    with_status,
)

import uq
from uq.assess import stopping
from uq.assess.convergence import enough, running_estimates
from uq.assess.two_fidelities import twin_facts, with_twin
from uq.errors import InputError
from uq.explore.rare_events import ESTIMATORS as RARE
from uq.explore.rare_events import rare_event
from uq.indices.methods import fed_by
from uq.result.result import Result
from uq.sampling.designs import DESIGNS

DRAWN = [name for name, design in DESIGNS.items() if getattr(design, "draw", None) is not None]
FIRST = {method: name for name in reversed(DRAWN) for method in fed_by(DESIGNS[name])}
FED = sorted({(design, method) for method, design in FIRST.items()}) + [
    (name, fed_by(DESIGNS[name])[0]) for name in DRAWN if name not in FIRST.values()
]
"""Each method with the first design that feeds it, and each other design with its own method."""

ROWS = {
    "hdmr": 1024,
    "quantile": 512,
    "first-order": 512,
    "rbd-fast": 512,
    "shapley": 256,
    "fast": 257,
    "morris": 32,
}
"""Other methods have enough in 128 samples."""


EXACT = dict.fromkeys(("S1", "ST", "shapley"), lambda i: i**2 / 30) | dict.fromkeys(
    ("mu", "mu_star"), float
)
"""Index of x_i for the sum, which is the rate of the life."""


@cache
def result(design, samples=256):
    """Return y = x1 + 2 x2 + 3 x3 + 4 x4, a life, a constant, and a regime that x4 decides."""
    ds = linear(design, samples=samples, replicates=1 if DESIGNS[design].independent else 4)
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
    ds = ds.assign(regime=("row", (ds["x4"].values > 0.5).astype(np.int8), attrs))
    return asking(ds, thresholds={"life": 0.2})


def damaged(ds, how, outputs=("y", "flat", "life")):
    ds = ds.copy(deep=True)
    lost = {"one failed row": [5], "all failed": slice(None)}.get(how)
    if lost is not None:
        for name in outputs:
            ds[name][lost] = np.nan
        if "regime" in ds:
            ds["regime"][lost] = -1
        ds["status"][lost] = 2
    elif how == "one infinite life" and "life" in ds:
        ds["life"][5] = np.inf
    elif how == "interrupted":
        ds = ds.isel(row=slice(None, ds.sizes["row"] - 7))
    return ds


DAMAGES = ["none", "one failed row", "one infinite life", "all failed", "interrupted"]


def case(*parameters, quick):
    return pytest.param(*parameters, marks=[] if quick else [pytest.mark.slow])


PLAIN = {(design, "first-order") for design in ("latin-hypercube", "sobol", "halton", "rbd-fast")}
ALIKE = PLAIN | {
    ("monte-carlo", "hdmr"),
    ("monte-carlo", "hsic-target"),
    ("shapley", "shapley"),
    ("morris-optimised", "morris"),
}
"""Designs whose rows are like those of another, and methods that take long."""

WALKED = {
    "one failed row": ALIKE - {("monte-carlo", "hdmr")},
    "one infinite life": {("sobol", "first-order")},
    "interrupted": {("latin-hypercube", "first-order")},
}
"""Damage -> those of them that meet it among the quick tests."""


def strict(data):
    """Return what is printed as JSON; a number that is not finite is a mistake."""
    return json.loads(json.dumps(data, allow_nan=False))


@pytest.mark.parametrize(
    ("design", "method", "damage"),
    [
        case(
            *fed, damage, quick=damage == "all failed" or fed not in ALIKE or fed in WALKED[damage]
        )
        for damage in DAMAGES[1:]
        for fed in FED
    ],
)
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
    whole = result(design, ROWS.get(method, 128))
    whole = sensitivities(whole, method, list(answered))["outputs"]
    for name, entry in answered.items():
        for kind, indices in entry.items():
            if isinstance(indices, dict) and kind not in ("dummy", "S2", "sigma", "p"):
                values = {label: index["value"] for label, index in indices.items()}
                assert kind == "mu" or values["x4"] > values["x1"], (name, kind, values)
                # A row in hundreds changes little; where the answer is known it is that one.
                undamaged = {label: index["value"] for label, index in whole[name][kind].items()}
                near = 0.3 if kind.startswith("mu") else 0.2
                assert values == pytest.approx(undamaged, abs=near), (name, kind)
                if kind in EXACT and name == "y":
                    exact = [EXACT[kind](i) for i in (1, 2, 3, 4)]
                    assert list(values.values()) == pytest.approx(exact, abs=0.2), (name, kind)
    refused = {name: entry["refused"] for name, entry in outputs.items() if "refused" in entry}
    assert all(len(sentence) > 20 for sentence in refused.values())


EVERY_DAMAGE = ("monte-carlo", "latin-hypercube", "sobol")
"""Designs that meet each damage among the quick tests; the others a failed row."""


@pytest.mark.parametrize(
    ("design", "damage"),
    [
        case(design, damage, quick=design in EVERY_DAMAGE or damage == "one failed row")
        for design in DRAWN
        for damage in DAMAGES
    ],
)
def test_summary_survival_fits_and_regimes(design, damage):
    ds = damaged(result(design, 256 if DESIGNS[design].follows_laws else ROWS["morris"]), damage)
    statistics = strict(summarised(ds, fits=True))
    y, life, flat = (statistics["outputs"][name] for name in ("y", "life", "flat"))
    curve = uq.survival(ds, "life")
    compared = uq.regimes(ds)
    if damage == "all failed" or not DESIGNS[design].follows_laws:
        assert y["mean"] is flat["mean"] is life["b_lives"]["B10"]["value"] is None
        assert y["failed"] == statistics["rows_used"] == life["failed"]
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


# Methods that compute more rows, or look at fewer ------------------------------------------------


OF_CROSSED = ("one failed row", "interrupted")
"""Damages that drop groups of rows of a crossed design, or let it be refused."""


@pytest.mark.parametrize(
    ("design", "damage"),
    [
        *((design, damage) for design in ("monte-carlo", "sobol") for damage in DAMAGES),
        *(case("saltelli", damage, quick=damage in OF_CROSSED) for damage in DAMAGES),
        *(case("shapley", damage, quick=damage not in OF_CROSSED) for damage in DAMAGES),
    ],
)
def test_running_estimates_and_whether_it_is_enough(design, damage):
    ds = damaged(result(design), damage)
    try:
        table = running_estimates(ds)
    except InputError as refusal:
        assert damage == "interrupted" and DESIGNS[design].crossed and "missing" in str(refusal)
        return
    last = table[table["samples"] == 256].set_index(["output", "estimate"])["value"]
    outputs = summarised(ds)["outputs"]
    for name in ("y", "flat", "life"):
        for label, value in (
            ("mean", outputs[name]["mean"]),
            ("quantile 0.5", outputs[name]["quantiles"]["0.5"]["value"]),
        ):
            assert last[name, label] == pytest.approx(
                np.nan if value is None else value, nan_ok=True
            )
    if damage == "all failed":
        assert last.isna().all()
    table = enough(ds)
    assert (table["warning"] == "").all()
    assert table.loc["flat", "sampling"] != 0  # never an interval of no width


CALM = {"distribution": "uniform", "lower": 0.0, "upper": 0.9}


def paired(x2=CALM, samples=200, **analysis):
    """Return a model with cheap outputs: a row with x2 > 0.9 fails, a life may be infinite."""
    return computed(
        study_of(
            {
                "study": {"name": "paired", "model": "linear"},
                "design": {"method": "monte-carlo", "samples": samples},
                "uncertain": {"x1": UNIFORM, "x2": x2},
                "analysis": {"twin": "near", "thresholds": {"y": 2.0, "life": 1.25}} | analysis,
            },
            PAIRED,
        )
    )


PAIRED = "sample_models:PAIRED"
PLAIN_MEAN = np.e - 1 + 0.3 * 0.45


@pytest.mark.parametrize("damage", [*DAMAGES, "constant"])
def test_twin(damage):
    ds = paired()
    if damage == "one failed row":
        ds["y"][5] = np.nan
        ds = with_status(ds, [5], 2)
    elif damage == "all failed":
        ds = paired({"distribution": "uniform", "lower": 0.95, "upper": 1.0})
    elif damage == "interrupted":
        ds = ds.isel(row=slice(None, 193))
    elif damage == "constant":
        ds["y"][:] = 0.1
    outputs = strict(twin_facts(with_twin(Result(ds), PAIRED)).json)["outputs"]
    if damage == "all failed":
        assert outputs == {}
        return
    mean, above = outputs["y"]["mean"], outputs["y"]["P(>2.0)"]
    if damage == "constant":
        assert mean["value"] == pytest.approx(0.1) and mean["low"] is mean["high"] is None
        assert above["value"] == above["low"] == 0 < above["high"] < 0.05
        return
    half = (mean["high"] - mean["low"]) / 2
    assert 0 < half < 0.05 and mean["value"] == pytest.approx(PLAIN_MEAN, abs=3 * half)
    # Half of the lives never end: they have no mean, and are above everything.
    assert "mean" not in outputs["life"]
    assert outputs["life"]["P(<1.25)"]["value"] == pytest.approx(0.2, abs=0.08)


@pytest.mark.parametrize("method", RARE)
@pytest.mark.parametrize(
    ("damage", "settings"),
    [("some failed rows", {"fail_above": 0.98}), ("all failed", {"fail_above": -1.0})],
)
def test_rare_events(method, damage, settings):
    study = study_of(
        {
            "study": {"name": "rare", "model": "linear"},
            "design": {"method": "monte-carlo", "samples": 64},
            "uncertain": dict.fromkeys(("x1", "x2", "x3", "x4"), UNIFORM),
            "settings": settings,
        }
    )
    try:
        size = {"samples": 150} if method == "active" else {"samples": 500, "replicates": 4}
        ds = rare_event(study, "y", 9.5, method=method, **size)
    except InputError as refusal:
        reasons = {"importance": "no design point", "active": "nothing to learn from"}
        assert reasons[method] in str(refusal)
        return
    if damage == "all failed":
        assert float(ds["probability"]) == 0 and int(ds["failed"]) == int(ds["rows"])
        assert "never" in ds.attrs["notes"] or "no row is beyond" in ds.attrs["notes"]
    else:
        # P(y > 9.5) = 0.5^4/576 without failures; of what is left, rows with x1 < 0.98.
        whole, lost = 0.5**4 / 576, (0.5**4 - 0.48**4) / 576
        assert float(ds["low"]) < whole and float(ds["high"]) > 0.5 * (whole - lost)
        assert "lower bound" in ds.attrs["notes"]


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("estimate", [{}, {"quantile": 0.5}, {"above": 6.0}])
def test_a_look_at_damaged_rows(damage, estimate):
    ds = damaged(linear(until={"output": "y", "half_width": 0.5} | estimate), damage, ("y",))
    seen = stopping.interim_estimate(Result(ds).study.design, Result(ds))
    if damage == "all failed":
        assert not seen.reached and np.isnan(seen.estimate.numbers[:2]).all()
        return
    truth = 0.34 if "above" in estimate else 5.0
    assert seen.estimate.value == pytest.approx(truth, abs=0.6 if truth == 5.0 else 0.15)
    assert seen.estimate.low < seen.estimate.value < seen.estimate.high
