"""Parameters that follow another: equal to it, or a factor of their own times it."""

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import computed, study_of
from input_studies import UNIFORM, inputs_of, refusal, tables
from scipy import stats

from uq.study.row_sampling import rows


def test_a_tied_parameter_has_the_value_of_the_other_and_no_column():
    study = study_of(tables({"x2": {"equals": "x1"}, "x1": UNIFORM}, "saltelli", 64))
    inputs = inputs_of(study)
    np.testing.assert_array_equal(inputs["x1"], inputs["x2"])
    assert rows(study) == 64 * 3
    ds = computed(study)
    assert ds["x2"].attrs["role"] == "input"
    # y = x1 + 2 x2 = 3 x1: all the variance is x1's.
    (entry,) = sensitivities(ds)["outputs"].values()
    assert entry["S1"].keys() == {"x1"} and entry["S1"]["x1"]["value"] == pytest.approx(1, abs=0.1)
    assert "x2 equals x1: the index of x1 is that of both" in entry["notes"]


def test_several_tied_parameters_share_a_note():
    ties = {"x2": {"equals": "x1"}, "x3": {"equals": "x1"}}
    ds = computed(study_of(tables(ties | {"x1": UNIFORM}, "saltelli", 64)))
    (entry,) = sensitivities(ds)["outputs"].values()
    notes = [note for note in entry["notes"] if "equal" in note]
    assert notes == ["x2 and x3 equal x1: the index of x1 is that of all of them"]


def test_a_scaled_parameter_is_the_other_times_a_factor_of_its_own():
    factor = {"distribution": "uniform", "lower": 0.4, "upper": 0.6, "times": "x1"}
    study = study_of(tables({"x2": factor, "x1": UNIFORM}, "saltelli", 1024))
    inputs = inputs_of(study)
    share = inputs["x2"] / inputs["x1"]
    assert 0.4 <= share.min() and share.max() <= 0.6
    assert abs(stats.spearmanr(share, inputs["x1"]).statistic) < 0.05
    # y = x1 (1 + 2 f): E(y|x1) = 2 x1, E(y|f) = (1 + 2 f)/2.
    (entry,) = sensitivities(computed(study))["outputs"].values()
    vx, vf = 0.8**2 / 12, 0.2**2 / 12
    total = (vx + 0.25) * (4 * vf + 4) - 1
    assert entry["S1"]["x1"]["value"] == pytest.approx(4 * vx / total, abs=0.02)
    assert entry["S1"]["x2"]["value"] == pytest.approx(4 * vf / 4 / total, abs=0.02)


def test_no_product_leaves_the_bounds():
    factor = {"distribution": "lognormal", "median": 1.0, "sigma": 0.02, "times": "x1"}
    study = study_of(tables({"x1": UNIFORM, "x2": factor}))
    assert inputs_of(study)["x2"].max() <= 1.0
    wide = refusal(tables({"x1": UNIFORM, "x2": factor | {"sigma": 0.1}}))
    # P(f > 1/x) for a lognormal f, averaged over x uniform on [0.1, 0.9].
    x = np.linspace(0.1, 0.9, 100_001)
    outside = stats.lognorm.sf(1 / x, 0.1).mean()
    assert wide.startswith(f"[uncertain.x2]: the product has {outside:.2g} of its probability")


@pytest.mark.parametrize(
    ("uncertain", "message"),
    [
        (
            {"x1": UNIFORM, "x2": {"equals": "x11"}},
            '[uncertain.x2] equals = "x11": is not an uncertain parameter with its own law;'
            " did you mean 'x1'? (allowed: x1)",
        ),
        ({"x1": UNIFORM, "x2": {"equals": "x2"}}, "is the parameter itself"),
        (
            {"x1": UNIFORM, "x2": {"equals": "x1", "distribution": "normal"}},
            '[uncertain.x2] distribution = "normal": no such argument of x2\'s law'
            " (allowed: equals, source, level)",
        ),
        ({"x1": UNIFORM, "x2": {"equals": "x1"}, "x3": {"equals": "x2"}}, "(allowed: x1)"),
        ({"x1": UNIFORM, "x2": UNIFORM | {"times": "x3"}}, "(allowed: x1)"),
        (
            {"x1": {"distribution": "integer-range", "lower": 0, "upper": 1}}
            | {"x2": UNIFORM | {"times": "x1"}},
            '[uncertain.x2] times = "x1": must not change sign or be zero: is within 0 to 1',
        ),
    ],
)
def test_what_cannot_be_followed_is_refused(uncertain, message):
    assert message in refusal(tables(uncertain))


def test_what_is_tied_must_have_the_same_unit():
    depth = {"distribution": "uniform", "lower": 1e-5, "upper": 1e-4}
    entries = {"depth": depth, "rate": {"equals": "depth"}}
    message = refusal(tables(entries, model="exponential-wear"))
    assert "is in another unit, m, than 'rate', m s-1" in message
