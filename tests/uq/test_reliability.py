"""Rare events: known probabilities, what has no value, who computes, what is refused."""

import json
import sys

import numpy as np
import openturns as ot
import pytest
from computed import UNIFORM, as_text, study_of, with_seed
from limit_states import PARTS, PLANE
from scipy import integrate, stats

import uq as api
from uq.errors import InputError
from uq.exploring.design_points import design_points, drawn_around
from uq.exploring.rare_event_intervals import log_scatter_interval, subset_interval
from uq.exploring.rare_events import rare_event
from uq.exploring.subset_simulation import Found, subset_simulation
from uq.rows.sampling import row_block

UNIFORMS = dict.fromkeys(("x1", "x2", "x3", "x4"), UNIFORM)
LAST = 10.0 - 576e-6**0.25  # P(x1 + 2 x2 + 3 x3 + 4 x4 > 10 - h) = h^4/576 for h < 1
WEAR = {
    "rate": {"distribution": "lognormal", "median": 2.5e-10, "sigma": 0.5},
    "depth": {"distribution": "lognormal", "median": 2.5e-4, "sigma": 0.2},
}
LIFE = stats.lognorm(s=np.hypot(0.5, 0.2), scale=1e6)


def study(model, inputs, **tables):
    names = {"branches": "limit_states:BRANCHES", "oscillator": "limit_states:OSCILLATOR"}
    return study_of(
        {
            "study": {"name": "rare", "model": "linear"},
            "design": {"method": "monte-carlo", "samples": 64, "seed": 3},
            "uncertain": inputs,
            **tables,
        },
        names.get(model, model),
    )


def branches(**tables):
    return study("branches", PLANE, **tables)


def linear(**tables):
    return study("linear", UNIFORMS, **tables)


def interval(ds):
    return float(ds["low"]), float(ds["high"])


def close(ds, truth):
    """Return whether the truth lies within twice the half-width: one seed is one draw."""
    low, high = np.log(interval(ds))
    return abs(np.log(truth) - (low + high) / 2) <= high - low


KNOWN = [
    # Normal and uniform sums, and a lognormal life: closed forms.
    (branches(), "sum", 4.753424, False, 1e-6),
    (branches(), "sum", -4.264891, True, 1e-5),
    (linear(), "y", LAST, False, 1e-6),
    (study("exponential-wear", WEAR), "life", LIFE.ppf(1e-5), True, 1e-5),
    (study("exponential-wear", WEAR), "life", LIFE.isf(1e-5), False, 1e-5),
    # Echard, Gayton, Lemaire, Relun, Reliab. Eng. Syst. Saf. 111, 232-240 (2013): 9.09e-6.
    (study("oscillator", PARTS), "excess", 0.0, False, 9.09e-6),
    # Waarts (2000), as in Echard, Gayton, Lemaire, Struct. Saf. 33, 145-154 (2011): 2.22e-3.
    (branches(), "demand", 0.0, False, 2.22e-3),
    (branches(), "turn", 4.753424, False, 2e-6),
    # The event y > 4.5 of a stair of quarters is that of a normal beyond 4.75.
    (branches(), "step", 4.5, False, stats.norm.sf(4.75)),
]


@pytest.mark.parametrize(("of", "output", "threshold", "below", "truth"), KNOWN)
def test_subset_simulation_finds_known_probabilities(of, output, threshold, below, truth):
    ds = rare_event(of, output, threshold, below)
    assert close(ds, truth)
    assert interval(ds)[1] < 2.5 * interval(ds)[0]
    assert int(ds["rows"]) < 60_000


@pytest.mark.parametrize(("names", "beyond"), [(("x1", "x2"), 4.264891), (tuple("abcd"), 3.719016)])
def test_subset_simulation_agrees_with_that_of_openturns(names, beyond):
    d = len(names)

    def margin(u):
        return np.asarray(u).sum(axis=1) / np.sqrt(d) - beyond

    ot.RandomGenerator.SetSeed(1)
    function = ot.PythonFunction(d, 1, func_sample=lambda u: margin(u)[:, None])
    vector = ot.CompositeRandomVector(function, ot.RandomVector(ot.Normal(d)))
    algorithm = ot.SubsetSampling(ot.ThresholdEvent(vector, ot.Greater(), 0.0))
    algorithm.setMaximumOuterSampling(80)
    algorithm.setBlockSize(100)
    algorithm.run()
    theirs = algorithm.getResult().getProbabilityEstimate()
    found = subset_simulation(margin, d, 1000, np.random.default_rng(1).spawn(8))
    ours = np.mean([one.probability for one in found])
    truth = stats.norm.sf(beyond)
    assert ours == pytest.approx(truth, rel=0.25)
    assert ours == pytest.approx(theirs, rel=0.5)


@pytest.mark.parametrize(("of", "output", "threshold", "below", "truth"), KNOWN[:-1])
def test_importance_sampling_finds_known_probabilities(of, output, threshold, below, truth):
    ds = rare_event(of, output, threshold, below, method="importance")
    assert close(ds, truth)
    assert interval(ds)[1] < 1.5 * interval(ds)[0]
    assert "subset" in ds.attrs["notes"]


def test_every_design_point_is_found():
    ds = rare_event(branches(), "demand", 0.0, method="importance")
    assert ds["reliability_index"].values == pytest.approx([3.0, 3.0, 3.5, 3.5], abs=1e-3)
    corners = {tuple(np.sign(point).astype(int)) for point in ds["location"].values}
    assert corners == {(1, 1), (-1, -1), (1, -1), (-1, 1)}
    assert ds["first_order"].values == pytest.approx(stats.norm.sf([3, 3, 3.5, 3.5]), rel=1e-2)


def test_what_is_not_rare_is_found_by_the_first_rows_and_said():
    ds = rare_event(linear(), "y", 5.0)
    assert close(ds, 0.5)
    assert int(ds["rows"]) == 8000
    assert "not a rare event" in ds.attrs["notes"]


def test_the_typical_row_of_the_event_is_shown():
    typical = rare_event(linear(), "y", LAST)["typical"].sel(parameter=["x1", "x4"]).values
    # Given y > 10 - h, the shortfalls i (1 - x_i) are uniform on a simplex of size h.
    median = 1 - stats.beta(1, 4).median() * (10 - LAST) / np.array([1, 4])
    assert typical == pytest.approx(median, abs=0.02)


# Rows without a value ----------------------------------------------------------------------------


@pytest.mark.parametrize("how", ["nan", "raise", "shape"])
def test_failed_rows_count_as_outside_and_are_said(how):
    of = linear(settings={"fail_above": 0.97, "fail_how": how})
    ds = rare_event(of, "y", 9.0, samples=500)
    # Given x1, the shortfalls of the others must stay below it: x1^3/144.
    truth = 0.97**4 / (4 * 144)
    assert close(ds, truth)
    assert 0 < int(ds["failed"]) < int(ds["rows"])
    assert f"{int(ds['failed'])} of {int(ds['rows'])} rows" in ds.attrs["notes"]
    with pytest.raises(InputError, match="use method 'subset'"):
        rare_event(linear(settings={"fail_above": 1e-4}), "y", 9.0, method="importance")


def test_lifetimes_that_never_end_lie_above_everything():
    of = study("exponential-wear", WEAR, fixed={"threshold": 2.5e-10})
    ds = rare_event(of, "life", 1e9)
    assert close(ds, 0.5)
    # Most rows never end: the event lies in what is left of them.
    of = study("exponential-wear", WEAR, fixed={"threshold": 1e-9})
    rate = stats.lognorm(s=0.5, scale=2.5e-10)
    nodes = stats.lognorm(s=0.2, scale=2.5e-4).ppf((np.arange(100_000) + 0.5) / 100_000)
    truth = rate.sf(np.maximum(nodes / 1e5, 1e-9)).mean()
    ds = rare_event(of, "life", 1e5, below=True)
    assert close(ds, truth)


def test_undefined_and_censored_rows_lie_on_neither_side():
    of = study("sample_models:KINDS", {"x1": UNIFORM, "x2": UNIFORM})
    ds = rare_event(of, "angle", 0.99)
    assert close(ds, 0.01)
    assert int(ds["undefined"]) > 0 and "neither side" in ds.attrs["notes"]
    name = "life[side=left,depth=0.5]"
    ds = rare_event(of, name, 1.2, below=False)  # never below x1 = 0.2, x1 + 0.5 > 1.2 else
    assert close(ds, 0.5)
    ds = rare_event(of, name, 1.45)  # rows beyond x1 = 0.8 were censored before 1.45
    assert int(ds["failed"]) > 0 and "censored" in ds.attrs["notes"]


def test_a_threshold_out_of_reach_is_bounded_by_the_levels_that_were_reached():
    for of, output, threshold in ((linear(), "y", 10.5), (branches(), "turn", 90.0)):
        ds = rare_event(of, output, threshold, samples=200, replicates=2)
        assert float(ds["probability"]) == float(ds["low"]) == 0
        assert set(ds["ended"].values) <= {"smallest", "plateau"}
        assert 0 < float(ds["high"]) < 0.01
        assert f"below {float(ds['high']):.2g}" in ds.attrs["notes"]


def test_all_rows_failed_is_no_event():
    ds = rare_event(linear(settings={"fail_above": -1.0}), "y", 9.0, samples=200, replicates=2)
    assert float(ds["probability"]) == 0 and int(ds["failed"]) == int(ds["rows"]) == 400


# What the rows support ---------------------------------------------------------------------------


def flat(u, share=2e-5):
    return np.where(stats.norm.sf(u[:, 0]) < share, 1.0, -1.0)


def test_a_plateau_supports_what_its_independent_rows_do():
    found = subset_simulation(flat, 2, 1000, np.random.default_rng(1).spawn(8))
    assert [one.ended for one in found] == ["plateau"] * 8
    assert [one.levels for one in found] == [1] * 8
    low, high = subset_interval(found, 1000)
    assert low == 0 and high == pytest.approx(4.6e-4, rel=0.01)  # 1 - 0.025^(1/8000)


def test_on_a_plateau_the_command_prints_what_the_rows_support():
    # A life that never ends is one plateau.
    of = study("exponential-wear", WEAR, fixed={"threshold": 1.8e-9})
    ds = rare_event(of, "life", 1e9, below=True)  # ends in 4e-5 of rows, and then long before
    assert 2e-5 < LIFE_ENDS < 8e-5
    assert float(ds["low"]) <= LIFE_ENDS <= float(ds["high"])
    assert "1e-12" not in ds.attrs["notes"]
    if float(ds["probability"]) == 0:
        assert "plateau" in ds.attrs["notes"] and "0.00046" in ds.attrs["notes"]


LIFE_ENDS = stats.norm.sf(np.log(1.8e-9 / 2.5e-10) / 0.5)


@pytest.mark.slow
@pytest.mark.parametrize("share", [2e-5, 3e-4, 2e-3])
def test_intervals_on_a_plateau_hold_the_truth(share):
    held = 0
    for seed in range(60):
        found = subset_simulation(
            lambda u: flat(u, share), 2, 500, np.random.default_rng(seed).spawn(8)
        )
        low, high = subset_interval(found, 500)
        held += low <= share <= high
    assert held >= 55


def test_replicates_that_never_got_there_count_with_the_level_they_reached():
    inside = np.zeros((1, 2))
    there = [Found(one, 5, inside, 1e-4, 0, "event") for one in (1e-6, 2e-6, 1.5e-6, 1.2e-6)]
    stuck = [Found(0.0, 3, inside, 1e-3, 0, "plateau")]
    low, high = subset_interval(there + stuck, 1000)
    assert 0 <= low < 1e-6 and 2e-4 < high <= 1 - 0.025 ** (1 / 5000)


def test_failed_rows_within_the_event_have_a_bound_of_their_own():
    ds = rare_event(linear(settings={"fail_above": 0.97}), "y", 9.0, samples=500)
    # 3 % of the independent rows failed.
    assert 0.025 < float(ds["failed_high"]) < 0.04
    assert f"no more than {float(ds['failed_high']):.2g}" in ds.attrs["notes"]
    assert np.isnan(rare_event(linear(), "y", 9.0, samples=500)["failed_high"])


# Who computes ------------------------------------------------------------------------------------


RANK = 0.6
H = 0.01  # (2 - a)(2.5 - b) > 5 - H, a and b uniform: an integral over a
CORNER = integrate.quad(lambda a: (H - 2.5 * a) / (2.0 - a), 0.0, H / 2.5)[0]
TIES = [
    # x1 and x2 standard normal with the correlation of a Gaussian copula; the same; one a multiple.
    (
        PLANE,
        {"parameters": ["x1", "x2"], "rank_correlation": [[1.0, RANK], [RANK, 1.0]]},
        5.0,
        stats.norm.sf(5.0 / np.sqrt(1.0 + 2.0 * np.sin(np.pi * RANK / 6.0))),
    ),
    (PLANE | {"x2": {"equals": "x1"}}, None, 5.0, stats.norm.sf(5.0 / np.sqrt(2.0))),
    (
        {
            "x1": {"distribution": "uniform", "lower": 1.0, "upper": 2.0},
            "x2": {"distribution": "uniform", "lower": 0.5, "upper": 1.5, "times": "x1"},
        },
        None,
        (5.0 - H) / np.sqrt(2.0),
        CORNER,
    ),
]


@pytest.mark.parametrize(
    ("inputs", "dependence", "threshold", "truth"), TIES, ids=("copula", "tied", "scaled")
)
def test_inputs_that_depend_on_each_other_do_so_in_a_rare_event(
    inputs, dependence, threshold, truth
):
    tables = {"dependence": dependence} if dependence else {}
    ds = rare_event(study("branches", inputs, **tables), "sum", threshold, samples=500, workers=0)
    assert close(ds, truth)


def test_rows_that_kill_their_process_are_failed_rows():
    of = linear(settings={"fail_above": 0.98, "fail_how": "exit"})
    ds = rare_event(of, "y", 1.0, below=True, samples=100, replicates=1)
    assert ds["failed"] > 0 and ds["probability"] > 0
    assert "killed its process" in ds.attrs["notes"]


def test_imported_rows_have_no_laws_to_draw_from(folder):
    (folder / "rows.csv").write_text("x1,x2\n" + "0.5,0.5\n" * 64)
    tables = {
        "study": {"name": "imported", "model": "linear"},
        "design": {"method": "imported", "samples": 64, "file": "rows.csv"},
        "uncertain": {"x1": UNIFORM, "x2": UNIFORM},
    }
    (folder / "study.toml").write_text(as_text(tables))
    with pytest.raises(InputError, match=r"study.toml: \[design\] method = 'imported'") as refused:
        rare_event("study.toml", "y", LAST)
    assert len(refused.value.lines) == 1


@pytest.mark.slow
def test_workers_change_no_bit():
    here, there = (
        rare_event(linear(), "y", LAST, samples=200, replicates=2, workers=workers)
        for workers in (0, 2)
    )
    assert here.identical(there)


def test_the_seed_of_the_study_decides():
    one, same, other = (
        rare_event(of, "y", LAST, samples=200, replicates=2)
        for of in (linear(), linear(), with_seed(linear(), 4))
    )
    assert one.identical(same)
    assert not np.array_equal(one["estimate"], other["estimate"])


def test_random_numbers_of_a_model_are_part_of_the_event():
    # work = x1 + up to 6e-3 from the row's own seed: beyond 1.005 only by both.
    of = study("sample_models:KINDS", {"x1": UNIFORM, "x2": UNIFORM})
    ds = rare_event(of, "work[side=right]", 1.0)
    truth = np.mean(np.arange(7) * 1e-3)
    assert close(ds, truth)


# Command and refusals ----------------------------------------------------------------------------


def test_the_command_shows_and_writes_json(uq, write_study):
    path = write_study("linear", uncertain=("x1", "x2", "x3", "x4"), law='distribution="uniform",'
                       "lower=0.0, upper=1.0")  # fmt: skip
    options = ("--output", "y", "--above", "9.5", "--samples", 200)
    ended = uq("rare-event", path, *options)
    assert ended.code == 0 and "95 % interval" in ended.out
    assert ended.out.startswith("P(y > 9.5)")
    found = json.loads(uq("rare-event", path, *options, "--json").out)
    low, value, high = (found["probability"][key] for key in ("low", "value", "high"))
    assert low < value < high
    assert low <= 0.5**4 / 576 <= high
    assert list(found["typical"]) == ["x1", "x2", "x3", "x4"]
    point = json.loads(uq("rare-event", path, *options, "--method", "importance", "--json").out)
    assert point["design_points"][0]["location"]["x4"] > 0.9
    assert uq("rare-event", path, "--output", "y").err.startswith("uq: give one of")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"output": "z"}, "no such output"),
        ({"threshold": np.nan}, "threshold must be finite"),
        ({"method": "subsett"}, "did you mean 'subset'"),
        ({"samples": 99}, "samples must be at least 100: 99"),
        ({"replicates": 0}, "replicates must be at least 1: 0"),
        ({"workers": -1}, "workers must not be negative"),
    ],
)
def test_mistakes_are_said_in_a_line(arguments, words):
    with pytest.raises(InputError, match=words):
        rare_event(**({"study": linear(), "output": "y", "threshold": 9.0} | arguments))


def test_an_element_must_be_named():
    of = study("sample_models:KINDS", {"x1": UNIFORM, "x2": UNIFORM})
    for name, words in (
        ("life", r"choose one, such as 'life\[side=left,depth=0.5\]'"),
        ("life[side=left]", "no such element"),
        ("regime", "is a category"),
    ):
        with pytest.raises(InputError, match=words):
            rare_event(of, name, 1.0)


def test_without_openturns_there_is_a_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "openturns", None)
    with pytest.raises(InputError, match=r"pip install 'vibrolife\[reliability\]'"):
        rare_event(linear(), "y", LAST, method="importance")
    assert float(rare_event(linear(), "y", 5.0)["probability"]) > 0.4


# Long checks -------------------------------------------------------------------------------------


def plane(u):
    return u.sum(axis=1) / 2 - 4.753424


def corner(u):
    return stats.norm.cdf(u) @ np.array([1.0, 2.0, 3.0, 4.0]) - LAST


@pytest.mark.slow
@pytest.mark.parametrize("margin", [plane, corner])
@pytest.mark.parametrize("method", ["subset", "importance"])
def test_intervals_hold_the_truth(margin, method):
    first = np.random.default_rng(0).standard_normal((1000, 4))
    points = design_points(margin, first, margin(first))
    held, estimates = [], []
    for seed in range(300):
        generators = np.random.default_rng(seed).spawn(8)
        if method == "subset":
            found = [one.probability for one in subset_simulation(margin, 4, 1000, generators)]
        else:
            drawn = [drawn_around(points, 1000, rng) for rng in generators]
            found = [np.mean(weight * (margin(u) > 0)) for u, weight in drawn]
        low, high = log_scatter_interval(np.array(found))
        held.append(low <= 1e-6 <= high)
        estimates.append(np.mean(found))
    bias = np.mean(estimates) / 1e-6 - 1
    print(f"\n{margin.__name__} {method}: {np.mean(held):.1%}, bias {bias:.1%}")
    assert 0.92 <= np.mean(held) <= 0.98
    assert abs(bias) < 0.1


@pytest.mark.slow
def test_a_rare_angle_of_the_vibrator_against_brute_force():
    of = api.load_study("studies/vibrator-tolerances.toml")
    alone = of.model.alone("theory_disphasing_angle")
    limit, hits, total = 0.55, 0, 4_000_000
    every = of.with_samples(total)
    for start in range(0, total, 100_000):
        x, seed, *_ = row_block(every, start, start + 100_000)
        angle = alone.batch(x, seed, of.settings)[0]["theory_disphasing_angle"]
        hits += int((np.abs(angle) > limit).sum())
    brute = stats.binomtest(hits, total).proportion_ci(method="wilson")
    found = rare_event(of, "theory_disphasing_angle", limit)
    full = rare_event(of, "disphasing_angle", limit, method="importance")
    print(f"\nbrute force {hits / total:.3g}, subset {interval(found)}, full {interval(full)}")
    assert 3e-6 < hits / total < 3e-5
    for ds in (found, full):
        assert interval(ds)[0] < brute.high and brute.low < interval(ds)[1]
