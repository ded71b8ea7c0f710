"""Units that were not inspected learn what they share with those that were, and nothing else."""

import numpy as np
import pytest
from computed import computed, study_of
from learnt_studies import DEPTH, RATE, lognormal, measured, wear
from scipy import stats

from uq.assess.components_by_level import by_level
from uq.assess.fleet import fleet_of
from uq.assess.summary import summarise
from uq.errors import InputError, RunError
from uq.explore.updating import update
from uq.learning.answer import learnt, learnt_facts
from uq.learning.posterior_result import as_unit
from uq.learning.remaining_life import remaining
from uq.result.result import Result

NORMAL = {"distribution": "normal", "mean": 0.0, "sd": 2.0}
LISTED = {"distribution": "discrete-choice", "values": [1.0, 8.0], "level": "shared"}
CV = 0.5


def rows(units, samples=8000, **more):
    """Return lives a b^-2 exp(z/2) with a shared, listed a, and a z of each unit."""
    return computed(
        study_of(
            {
                "study": {"name": "learnt", "model": "scaled"},
                "design": {"method": "monte-carlo", "samples": samples, "units": units, "seed": 2},
                "uncertain": {"a": LISTED, "z": NORMAL} | more,
                "analysis": {"outputs": ["life"], "thresholds": {"life": [5.0]}},
            },
            "sample_models:SCALED",
        )
    )


def mean_and_sd(ds, values):
    mean = np.average(values, weights=ds["weight"])
    return mean, np.average((values - mean) ** 2, weights=ds["weight"]) ** 0.5


@pytest.mark.parametrize(("units", "lives"), [(2, (9.0,)), (3, (9.0, 20.0)), (5, (9.0, 20.0))])
def test_their_own_inputs_are_as_before(units, lives):
    ds = update(rows(units), measured(*lives, cv=CV))
    likely = np.ones(2)
    for life in lives:
        likely *= stats.norm.pdf(
            np.log(life), np.log([1.0, 8.0]), np.hypot(1.0, np.log1p(CV**2) ** 0.5)
        )
    share = likely[1] / likely.sum()
    assert np.average(ds["a"] == 8.0, weights=ds["weight"]) == pytest.approx(share, abs=0.02)
    assert mean_and_sd(ds, ds["z"].values) == pytest.approx((0.0, 2.0), abs=0.12)
    mean, _ = mean_and_sd(ds, np.log(ds["life"].values))
    assert mean == pytest.approx(share * np.log(8.0), abs=0.08)
    inspected = as_unit(ds, "A")
    assert mean_and_sd(inspected, inspected["z"].values)[1] < 1.6


def test_a_shared_scale_that_is_learnt_tells_nothing_of_them():
    ds = update(rows(2, b=lognormal(1.0, 0.3, "shared")), measured(0.2, cv=CV))
    mean, sd = mean_and_sd(ds, ds["z"].values)
    assert (mean, sd) == pytest.approx((0.0, 2.0), abs=0.12)
    scale, spread = mean_and_sd(ds, np.log(ds["b"].values))
    together = (ds["z"].values - mean) / sd * (np.log(ds["b"].values) - scale) / spread
    assert scale > 0.1 and abs(np.average(together, weights=ds["weight"])) < 0.06


def test_without_rows_of_their_own_they_have_no_life():
    ds = update(rows(2, samples=2000), measured(9.0, 20.0, cv=CV))
    why = "set [design] units = 3 or more"
    assert any(why in note for note in summarise(Result(ds)).notes)
    document = learnt_facts(learnt(ds)).json
    assert document["uninspected"] == {} == document["units"]  # measured lives have ended
    assert any(why in note for note in document["notes"])
    assert not any(why in note for note in summarise(Result(as_unit(ds, "A"))).notes)


@pytest.mark.slow
def test_fleets_of_units_that_share_only_what_is_integrated():
    """All rows then count alike: what is shared is narrower, and the units are as before."""
    lives = np.array([6e5, 7e5, 5e5])
    ds = update(wear(3000, depth="shared", units=4), measured(*lives, cv=CV))
    sd, noise = RATE[1], np.hypot(RATE[1], np.log1p(CV**2) ** 0.5)
    spread = (DEPTH[1] ** -2 + 3 * noise**-2) ** -0.5
    seen = np.log(lives) - np.log(DEPTH[0] / RATE[0])
    middle = np.log(DEPTH[0] / RATE[0]) + spread**2 * seen.sum() / noise**2
    z = np.linspace(-6, 6, 2001)
    p = stats.norm.cdf((np.log(6e5) - middle - spread * z) / sd)
    none = np.average((1 - p) ** 3, weights=np.exp(-(z**2) / 2))
    kept = fleet_of(Result(ds), 3, [6e5]).by[6e5][1].estimate
    assert kept.low < none < kept.high and kept.high - kept.low < 0.06
    probability = learnt_facts(learnt(ds, [6e5])).json["uninspected"]["life"]["by"]["600000.0"]
    ends = stats.norm.cdf((np.log(6e5) - middle + spread * np.array([-1.96, 1.96])) / sd)
    assert list(probability["over_shared"].values()) == pytest.approx(ends, abs=0.02)
    share = by_level(Result(ds)).outputs["log(life)"].shares["shared"]
    truth = spread**2 / (spread**2 + sd**2)
    assert share.low < truth < share.high and share.high < DEPTH[1] ** 2 / (DEPTH[1] ** 2 + sd**2)
    with pytest.raises(InputError, match="no fleets: these rows represent unit 'A'"):
        fleet_of(Result(as_unit(ds, "A")), 3)


@pytest.mark.parametrize(
    ("units", "why"),
    [(2, "set .design. units = 3 or more"), (4, "each unit of a sample separately")],
)
@pytest.mark.parametrize(
    "question",
    [lambda ds: fleet_of(Result(ds), 2), lambda ds: by_level(Result(ds))],
    ids=["fleet", "levels"],
)
def test_units_that_are_weighted_one_by_one_have_no_fleet(units, why, question):
    ds = update(rows(units, samples=2000), measured(9.0, 20.0, cv=CV))
    with pytest.raises(InputError, match=why):
        question(ds)


def test_the_range_over_what_is_shared_needs_its_probabilities_without_noise():
    """A few units of a world do not give them; and units that share nothing have no range."""
    of_worlds = update(wear(600, rate="shared", units=3), measured(6e5, 7e5, cv=CV))
    nothing = update(wear(600), measured(6e5, cv=CV))
    for ds in (of_worlds, nothing):
        of_time = learnt_facts(learnt(ds, [6e5])).json["uninspected"]["life"]["by"]["600000.0"]
        assert "over_shared" not in of_time and of_time["value"] > 0


@pytest.mark.slow
def test_ranges_over_what_is_shared_hold_the_truth():
    """95 % of 1,000 worlds drawn from the study, three units of each inspected."""
    rng, held = np.random.default_rng(4), []
    ds = wear(1000, depth="shared", units=4)
    for _ in range(1000):
        depth = DEPTH[0] * np.exp(DEPTH[1] * rng.standard_normal())
        rates = RATE[0] * np.exp(RATE[1] * rng.standard_normal(3))
        noise = np.exp(np.log1p(CV**2) ** 0.5 * rng.standard_normal(3))
        try:
            after = update(ds, measured(*(depth / rates * noise), cv=CV))
        except RunError:
            continue
        low, high = next(remaining(Result(after), [6e5])).over_shared[6e5].values()
        held.append(low <= stats.norm.cdf(np.log(6e5 * RATE[0] / depth) / RATE[1]) <= high)
    assert len(held) > 950 and 0.93 <= np.mean(held) <= 0.97


def test_units_of_a_sample_that_count_alike_do_so_after_smoothing():
    """Of a design whose samples are not independent; here its largest weights begin a sample."""
    design = {"method": "latin-hypercube", "replicates": 8, "samples": 216, "units": 3}
    after = update(wear(**design, rate="shared"), measured(3e5, 4e5))
    weights = after["weight"].values.reshape(-1, 3)
    assert np.ptp(weights[:, 0]) > 0 and (weights == weights[:, :1]).all()
    assert fleet_of(Result(after), 2).first[0.5].estimate.value > 0


def test_units_that_do_not_differ_need_no_rows_of_their_own():
    ds = update(rows(1, z=NORMAL | {"level": "shared"}), measured(9.0, cv=CV))
    assert "only_inspected" not in ds.attrs
    assert mean_and_sd(ds, ds["z"].values)[1] < 1.6
