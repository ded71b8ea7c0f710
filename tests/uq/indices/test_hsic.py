"""Target and conditional sensitivity by HSIC: OpenTURNS against a few lines of numpy."""

import sys

import numpy as np
import openturns as ot
import pytest
from asked_indices import sensitivities
from computed import asking, kinds, linear, with_output, with_status
from scipy.stats import rankdata

from uq.contract import Status
from uq.errors import InputError

EVENT = "P(z>9.0)"
TARGET, CONDITIONAL = "hsic-target", "hsic-conditional"


def decided(samples=600):
    """Return a result whose z exceeds 9 where x1 is large; then x2 matters, and nothing else."""
    ds = linear(samples=samples)
    x1, x2 = ds["x1"].values, ds["x2"].values
    return asking(with_output(ds, "z", 10 * (x1 > 0.7) + x2), thresholds={"z": 9.0})


def entry_of(ds, method, output=EVENT):
    return sensitivities(ds, method, output)["outputs"][output]


def values(entry, kind="hsic"):
    return {name: estimate["value"] for name, estimate in entry[kind].items()}


def gram(values):
    values = np.asarray(values, float)
    return np.exp(-0.5 * ((values[:, None] - values) / values.std()) ** 2)


def centred(matrix):
    return matrix - matrix.mean(axis=0) - matrix.mean(axis=1)[:, None] + matrix.mean()


def normalised(a, b):
    k, m = centred(gram(a)), centred(gram(b))
    return (k * m).sum() / np.sqrt((k * k).sum() * (m * m).sum())


def permuted(a, b, times=200):
    """Return the share of shuffled inputs with as large a dependence."""
    rng, k, m = np.random.default_rng(0), centred(gram(a)), centred(gram(b))
    orders = (rng.permutation(len(a)) for _ in range(times))
    return np.mean([(k[np.ix_(order, order)] * m).sum() >= (k * m).sum() for order in orders])


def test_what_decides_an_event_and_what_matters_given_that_it_happens_differ():
    ds = decided()
    target, conditional = (values(entry_of(ds, method)) for method in (TARGET, CONDITIONAL))
    assert max(target, key=target.get) == "x1" and max(conditional, key=conditional.get) == "x2"
    p = values(entry_of(ds, TARGET), "p")
    assert p["x1"] < 1e-6 and min(p["x2"], p["x3"], p["x4"]) > 0.01
    p = values(entry_of(ds, CONDITIONAL), "p")
    assert p["x2"] < 1e-6 and min(p["x1"], p["x3"], p["x4"]) > 0.01


@pytest.mark.slow
def test_indices_are_those_of_numpy_with_its_p_values_by_permutation():
    ds = decided(250)
    hits = ds["z"].values > 9
    for method, rows, y in (
        (TARGET, np.full(250, True), hits),
        (CONDITIONAL, hits, rankdata(ds["z"].values[hits])),
    ):
        entry = entry_of(ds, method)
        for name, value in values(entry).items():
            x = rankdata(ds[name].values[rows])
            assert value == pytest.approx(normalised(x, y), rel=1e-9)
            assert values(entry, "p")[name] == pytest.approx(permuted(x, y), abs=0.1)


def test_indices_are_those_of_the_estimators_of_openturns_for_target_and_condition():
    ds = decided(300)
    z, hits = ds["z"].values, ds["z"].values > 9
    beyond = ot.IndicatorFunction(ot.Interval(9.0, float("inf")))

    def arguments(x, y):
        kernels = [ot.SquaredExponential([column.std()]) for column in (x, y)]
        return kernels, ot.Sample(x[:, None]), ot.Sample(z[:, None])

    x = rankdata(ds["x1"].values) / 300
    reference = ot.HSICEstimatorTargetSensitivity(*arguments(x, hits), ot.HSICVStat(), beyond)
    assert values(entry_of(ds, TARGET))["x1"] == pytest.approx(reference.getR2HSICIndices()[0])
    # Kernels as wide as the spread among the hits, whose ranks replace all values.
    x[hits], z[hits] = rankdata(ds["x2"].values[hits]), 9 + rankdata(z[hits])
    kernels = [ot.SquaredExponential([column[hits].std()]) for column in (x, z)]
    _, inputs, outputs = arguments(x, z)
    reference = ot.HSICEstimatorConditionalSensitivity(kernels, inputs, outputs, beyond)
    assert values(entry_of(ds, CONDITIONAL))["x2"] == pytest.approx(reference.getR2HSICIndices()[0])


def test_the_index_of_two_signs_is_their_squared_correlation():
    ds = decided()
    rng = np.random.default_rng(4)
    sign = np.where(rng.random(600) < 0.6, ds["z"].values > 9, rng.random(600) < 0.5)
    for first, second in ((0.0, 1.0), (7.0, -2.0)):  # whatever the two are called
        coded = ds.assign(x3=("row", np.where(sign, first, second), ds["x3"].attrs))
        squared = np.corrcoef(sign, ds["z"].values > 9)[0, 1] ** 2
        assert values(entry_of(coded, TARGET))["x3"] == pytest.approx(squared)


def test_an_increasing_function_of_input_or_output_changes_nothing():
    ds = decided()
    grown = ds.assign(x2=("row", np.exp(9 * ds["x2"].values), ds["x2"].attrs))
    assert entry_of(grown, CONDITIONAL) == entry_of(ds, CONDITIONAL)


def test_events_of_lives_and_regimes_are_decided_by_default():
    ds = kinds(samples=400, analysis={"outputs": ["regime", "life"], "thresholds": {"life": 3.0}})
    outputs = sensitivities(ds, TARGET)["outputs"]
    assert {"P(regime=slow)", "P(regime=fast)"} <= set(outputs)
    life = "P(life[side=left,depth=0.5]<3.0)"
    assert life in outputs and "refused" not in outputs["P(regime=slow)"]
    given = sensitivities(ds, CONDITIONAL)["outputs"]
    assert life in given and "P(regime=slow)" not in given
    asked = entry_of(ds, CONDITIONAL, "P(regime=slow)")
    assert "for what matters within a regime, use --regime" in asked["refused"]


def test_rows_without_a_value_are_left_out_and_counted():
    ds = with_status(decided(), slice(20), Status.NON_FINITE)
    ds["z"].values[:20] = np.nan
    for method in (TARGET, CONDITIONAL):
        entry = entry_of(ds, method)
        assert (entry["rows_used"], entry["groups_dropped"]) == (580, 20)
    hits = int((ds["z"].values > 9).sum())
    assert f"of the {hits} rows in which it happens" in entry["notes"][0]


def test_a_constant_input_has_no_index_and_few_hits_have_none():
    ds = decided()
    still = ds.assign(x4=("row", np.full(600, 0.5), ds["x4"].attrs))
    entry = entry_of(still, TARGET)
    assert entry["hsic"]["x4"]["value"] is None and entry["p"]["x4"]["value"] is None
    assert entry["hsic"]["x1"]["value"] > 0.2
    rare = asking(ds, thresholds={"z": 10.98})
    assert "are needed" in entry_of(rare, TARGET, "P(z>10.98)")["refused"]
    few = asking(ds, thresholds={"z": 10.9})
    assert "64 are needed" in entry_of(few, CONDITIONAL, "P(z>10.9)")["refused"]
    never = asking(ds, thresholds={"z": 99.0})
    assert "the same value in all rows" in entry_of(never, TARGET, "P(z>99.0)")["refused"]


def test_rows_in_which_an_event_happens_need_no_others():
    ds = decided()
    limit = float(np.sort(ds["z"].values)[2:4].mean())
    most = asking(ds, thresholds={"z": limit})  # 3 rows lie below
    (note,) = entry_of(most, CONDITIONAL, f"P(z>{limit!r})")["notes"]
    assert note.startswith("of the 597 rows in which it happens")


def test_rough_indices_without_intervals_do_not_speak_of_any():
    ds = decided()
    limit = float(np.sort(ds["z"].values)[11:13].mean())
    few = asking(ds, thresholds={"z": limit})
    (note,) = entry_of(few, TARGET, f"P(z>{limit!r})")["notes"]
    assert note.startswith("only 12 misses in 600 rows: the indices are rough; about")


def test_without_an_event_there_is_a_sentence():
    with pytest.raises(InputError, match=r"'hsic-target' needs an event.*--output 'P\(y > t\)'"):
        sensitivities(linear(), TARGET)
    assert "not an event" in entry_of(decided(), TARGET, "z")["refused"]
    assert "not an event of an output" in entry_of(decided(), CONDITIONAL, "z")["refused"]


def test_without_a_row_there_is_another():
    ds = with_status(decided(), slice(None), Status.NON_FINITE)
    with pytest.raises(InputError, match="every row is invalid"):
        sensitivities(ds.assign(z=ds["z"] * np.nan), TARGET)


def test_without_openturns_there_is_a_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "openturns", None)
    refused = entry_of(decided(), TARGET)["refused"]
    assert refused == "OpenTURNS is not installed: pip install 'vibrolife[reliability]'"


def test_indices_depend_on_nothing_but_the_rows():
    ot.RandomGenerator.SetSeed(1)
    state = ot.RandomGenerator.GetState()
    ds = decided()
    assert entry_of(ds, TARGET) == entry_of(ds, TARGET)
    assert ot.RandomGenerator.GetState() == state


def test_small_p_values_are_shown_as_such(uq, tmp_path):
    path = tmp_path / "decided.nc"
    decided().to_netcdf(path)
    shown = uq("sensitivity", str(path), "--method", TARGET, "--output", "P(z > 9)").out
    (line,) = (text for text in shown.splitlines() if text.split()[:1] == ["x1"])
    assert line.split()[1:3] == ["<", "0.001"]
