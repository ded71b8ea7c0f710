"""What the error that rows state for themselves would do to a promise."""

import numpy as np
import pytest
from answered import lifetime
from computed import asking, linear, with_output

import uq
from uq.assess.answer.answer import answer


def values_that_err(size, design="monte-carlo", samples=1000, replicates=1, **asked):
    ds = asking(linear(design, samples=samples, replicates=replicates), outputs=["y"], **asked)
    return with_output(ds, "y_error", np.full(ds.sizes["row"], size))


def test_a_bound_says_where_it_would_lie_if_every_value_were_wrong_by_its_error():
    above = answer(values_that_err(0.2, wanted={"y": "above"})).lead
    assert np.isclose(
        above.own_error.members["lower"], above.tolerance_bound.lower - 0.2, rtol=1e-12
    )
    assert above.own_error.members["upper"] is None
    assert above.own_error.sentence.startswith(
        "The bound excludes numerical error; including it gives"
        f" {above.tolerance_bound.unit.text(above.own_error.members['lower'], -np.inf)}."
    )
    below = answer(values_that_err(-0.2, wanted={"y": "below"})).lead
    assert np.isclose(
        below.own_error.members["upper"], below.tolerance_bound.upper + 0.2, rtol=1e-12
    )
    worse = below.tolerance_bound.unit.text(below.own_error.members["upper"], np.inf)
    assert f"including it gives {worse}." in below.own_error.sentence
    both = answer(values_that_err(0.2)).lead.own_error.sentence
    assert both.startswith("The bounds exclude numerical error; including it gives ")
    assert " and " in both


def test_the_error_is_held_against_the_scatter():
    ds = values_that_err(0.5)
    solver_error = answer(ds).lead.own_error
    share = solver_error.members["share_of_variance"]
    assert np.isclose(share, 0.25 / np.var(ds["y"].values))
    assert f"is {100 * share:.1f} % of the variance" in solver_error.sentence
    assert "all scatter may be numerical" in answer(values_that_err(2.0)).lead.own_error.sentence


@pytest.mark.parametrize("size", [0.0, 1e-9])
def test_an_error_that_moves_no_digit_is_not_worth_a_word(size):
    assert answer(values_that_err(size)).lead.own_error.sentence == ""


def test_without_a_bound_it_is_named_whose_error_it_is():
    few = answer(values_that_err(0.5, samples=10)).lead
    assert few.tolerance_bound.sentence == ""
    assert few.own_error.sentence.startswith("The mean square of numerical error is")


def test_rows_that_all_state_nothing_are_counted():
    assert answer(values_that_err(np.nan, samples=100)).lead.own_error.sentence == (
        "100 rows state no error."
    )


def test_without_stated_errors_there_is_nothing_to_say():
    assert answer(asking(linear(samples=100), outputs=["y"])).lead.own_error is None


def test_rows_that_are_not_independent_move_their_quantile():
    ds = values_that_err(0.2, "saltelli", 64, 8, wanted={"y": "above"})
    lead = answer(ds).lead
    assert np.isclose(
        lead.own_error.members["lower"], lead.tolerance_bound.quantiles[0].value - 0.2, rtol=1e-9
    )
    assert lead.own_error.sentence.startswith("The quantile excludes numerical error; ")


def a_life_that_errs(relative):
    ds, _ = lifetime()
    life = ds["life"]
    error = life.copy(data=relative * life.values).assign_attrs(kind="value")
    return ds.assign(life=life.assign_attrs(accuracy=0.05), life_error=error)


def test_errors_of_lives_are_relative_and_a_missed_accuracy_is_said():
    ds = a_life_that_errs(0.1)
    lead = answer(ds).lead
    assert np.isclose(lead.own_error.members["lower"], 0.9 * lead.tolerance_bound.lower)
    assert np.isclose(
        lead.own_error.members["share_of_variance"], 0.01 / np.var(np.log(ds["life"].values))
    )
    assert lead.own_error.sentence.startswith("The bound excludes numerical error; including it")
    assert lead.own_error.sentence.endswith("100 % of the rows exceed the 5 % error target.")
    assert "target" not in answer(a_life_that_errs(0.04)).lead.own_error.sentence


def test_lives_without_an_end_and_rows_that_state_no_error_stay_as_they_are():
    ds = a_life_that_errs(0.1)
    life, error = ds["life"].values.copy(), ds["life_error"].values.copy()
    first = np.argsort(life)[:100]
    error[first[:50]], life[first[50:]] = np.nan, np.inf
    error[first[50:]] = np.nan
    ds = ds.assign(life=ds["life"].copy(data=life), life_error=ds["life_error"].copy(data=error))
    lead = answer(ds).lead
    assert lead.own_error.members["rows_stating_none"] == 50
    assert "50 rows state no error" in lead.own_error.sentence
    assert lead.own_error.members["lower"] == lead.tolerance_bound.lower


def test_its_numbers_are_in_the_json_and_are_traced():
    ds = a_life_that_errs(0.1)
    solver_error = answer(ds).fact.json["quantities"]["life"]["own_error"]
    assert solver_error["rows_missing_it"] == 1.0 and solver_error["accuracy"] == 0.05
    for name in ("lower", "share_of_variance", "rows_missing_it", "rows_stating_none"):
        traced = uq.trace(ds, f"answer/quantities/life/own_error/{name}")
        assert traced["value"] == solver_error[name]
    bound = uq.trace(ds, "answer/quantities/life/own_error/lower")
    assert [estimator["code"].rpartition(".")[2] for estimator in bound["estimators"]] == [
        "off_by_error",
        "tolerance_bounds",
    ]
