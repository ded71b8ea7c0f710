"""Whether an input only scales a life may depend on what a study fixes."""

import numpy as np
import pytest
from computed import computed, study_of, summarised
from scaled_studies import NORMAL, lognormal

from uq.assess.what_if import what_if
from uq.result.result import Result

SCATTER = {"a": lognormal(0.5)}


def delayed(uncertain=SCATTER, **tables):
    analysis = {"outputs": ["life"], "thresholds": {"life": [1.0]}}
    return study_of(
        {
            "study": {"name": "delayed", "model": "delayed"},
            "design": {"method": "monte-carlo", "samples": 200, "seed": 1},
            "uncertain": uncertain,
            "analysis": analysis,
            **tables,
        },
        "sample_models:DELAYED",
    )


def test_a_life_scales_where_nothing_delays_it():
    life = summarised(computed(delayed()))["outputs"]["life"]
    assert life["integrated"]["inputs"] == ["a"]
    assert life["thresholds"]["1.0"]["below"]["value"] == pytest.approx(0.5)


@pytest.mark.parametrize(
    "study", [{"fixed": {"z": 0.5}}, {"uncertain": SCATTER | {"z": NORMAL}}], ids=["fixed", "law"]
)
def test_a_life_that_may_be_delayed_is_counted_row_by_row(study):
    ds = computed(delayed(**study))
    life = summarised(ds)["outputs"]["life"]
    assert "integrated" not in life or not life["integrated"]["inputs"]
    expected = np.mean(ds["life"].values < 1.0)
    assert life["thresholds"]["1.0"]["below"]["value"] == expected
    # Without scales, another law of a needs weights of the rows.
    table = what_if(Result(ds), {"uncertain.a.median": 1.02})
    assert table.attrs["effective_rows"] < 200


def worn(seed=101, quantiles=(), **dependence):
    return study_of(
        {
            "study": {"name": "worn", "model": "exponential-wear"},
            "design": {"method": "monte-carlo", "samples": 4000, "seed": seed},
            "uncertain": {
                "rate": {"distribution": "lognormal", "median": 1e-9, "sigma": 0.6},
                "depth": {"distribution": "uniform", "lower": 1e-4, "upper": 4e-4},
            },
            "dependence": {"parameters": ["rate", "depth"]} | dependence,
            "analysis": {
                "thresholds": {"life": [43539.8, 109054.0]},
                **({"quantiles": list(quantiles)} if quantiles else {}),
            },
        }
    )


@pytest.mark.parametrize("copula", [{"copula": "clayton", "survival": True}, {}])
def test_a_rare_event_of_dependent_inputs_has_no_narrower_upper_end_than_plain_rows(copula):
    """P is 1.26e-4 and 1.37e-4; the rows that carry it may be absent, and the others agree."""
    ds = computed(worn(rank_correlation=[[1.0, 0.7], [0.7, 1.0]], **copula))
    rare, common = (
        summarised(ds)["outputs"]["life"]["thresholds"][t]["below"] for t in ("43539.8", "109054.0")
    )
    assert rare["low"] < 1.3e-4 < rare["high"]
    share = float((ds["life"] < 109054.0).mean())
    assert common["high"] - common["low"] < 2 * 1.96 * (share * (1 - share) / 4000) ** 0.5


def test_a_rare_quantile_of_dependent_inputs_has_no_lower_end_that_plain_rows_do_not_give():
    """With the rows that carry it absent, a third of the intervals began above the quantile."""
    given = {"rank_correlation": [[1.0, 0.7], [0.7, 1.0]], "copula": "clayton", "survival": True}
    for seed in range(100, 106):
        ds = computed(worn(seed, [1.26e-4, 1.26e-2], **given))
        rare, common = summarised(ds)["outputs"]["life"]["quantiles"].values()
        assert rare["low"] is None and rare["high"] > 43539.8
        assert "rows" in rare["reason"]
        assert common["low"] < common["value"] < common["high"]
