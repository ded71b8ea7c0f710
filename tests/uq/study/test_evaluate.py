"""Faults of a row stay with the row; faults of a model are refused."""

import dataclasses

import numpy as np
import pytest
import sample_models
import wrong_models

from models.analytic import EXPONENTIAL_WEAR, LINEAR
from uq.contract import Output, Status
from uq.study.evaluate import KernelError, evaluate, joined


def linear(x1, how, start=0):
    x = np.full((len(x1), 4), 0.5)
    x[:, 0] = x1
    settings = LINEAR.settings(fail_above=0.8, fail_how=how)
    return evaluate(LINEAR, settings, x, np.zeros(len(x1), np.uint64), start)


@pytest.mark.parametrize(
    ("how", "status", "message"),
    [
        ("nan", Status.NON_FINITE, "'y' is nan"),
        ("inf", Status.NON_FINITE, "'y' is inf"),
        ("raise", Status.RAISED, "ValueError: x1 is above fail_above = 0.8"),
        ("shape", Status.BAD_SHAPE, "'y' has shape (2,), expected (1,)"),
    ],
)
def test_the_guilty_rows_are_found_and_the_others_keep_their_values(how, status, message):
    x1 = np.linspace(0.0, 1.0, 37)
    x1[[5, 20]] = 0.9
    guilty = x1 > 0.8
    chunk = linear(x1, how, start=1000)
    assert np.array_equal(chunk.status, np.where(guilty, status, Status.OK))
    assert np.array_equal(np.isnan(chunk.columns["y"]), guilty)
    assert np.array_equal(chunk.columns["y"][~guilty], linear(x1[~guilty], how).columns["y"])
    assert chunk.failures == {status.label: (1005, message)}


def test_a_chunk_may_consist_of_guilty_rows():
    chunk = linear(np.full(5, 0.9), "raise")
    assert np.all(chunk.status == Status.RAISED)


def kinds(*x):
    return evaluate(
        sample_models.KINDS, sample_models.Settings(), np.array(x), np.arange(len(x), dtype="u8")
    )


def test_never_censored_and_undefined_are_no_failures():
    chunk = kinds((0.1, 0.5), (0.9, 0.5), (0.5, 0.1))
    assert np.all(chunk.status == Status.OK)
    assert np.all(np.isinf(chunk.columns["life"][0]))
    assert np.all(chunk.columns["life_censored"][1])
    assert np.isnan(chunk.columns["angle"][2])


def test_a_row_out_of_budget_keeps_what_it_reached():
    chunk = kinds((0.99, 0.5))
    assert chunk.status == [Status.OUT_OF_BUDGET]
    assert np.array_equal(chunk.columns["life"][0, 0], [1.49, 2.49])
    assert chunk.failures == {"out-of-budget": (0, Status.OUT_OF_BUDGET.meaning)}


def broken(output, value, **declared):
    model = dataclasses.replace(
        sample_models.KINDS,
        batch=lambda x, seed, settings: _replaced(x, seed, settings, output, value),
        outputs=dict(sample_models.KINDS.outputs)
        | {output: dataclasses.replace(sample_models.KINDS.outputs[output], **declared)},
    )
    x = np.array([(0.5, 0.5), (0.6, 0.5)])
    return evaluate(model, sample_models.Settings(), x, np.zeros(2, np.uint64))


def _replaced(x, seed, settings, output, value):
    outputs, status = sample_models.kinds(x, seed, settings)
    outputs[output][x[:, 0] > 0.55] = value
    return outputs, status


@pytest.mark.parametrize(
    ("output", "value", "declared"),
    [
        ("work", np.nan, {}),
        ("work", np.inf, {}),
        ("life", np.nan, {}),
        ("life", -np.inf, {}),
        ("angle", np.inf, {}),
        ("angle", np.nan, {"may_be_undefined": False}),
    ],
)
def test_a_number_that_cannot_be_blanks_the_whole_row(output, value, declared):
    chunk = broken(output, value, **declared)
    assert list(chunk.status) == [Status.OK, Status.NON_FINITE]
    assert chunk.failures == {"non-finite": (1, f"'{output}' is {value}")}
    assert np.isnan(chunk.columns["work"][1]).all()
    assert np.isnan(chunk.columns["life"][1]).all()
    assert not chunk.columns["life_censored"][1].any()
    assert list(chunk.columns["regime"]) == [0, -1]


@pytest.mark.parametrize(("output", "value"), [("life", np.inf), ("angle", np.nan)])
def test_a_declared_absence_is_legal(output, value):
    assert np.all(broken(output, value).status == Status.OK)


def test_what_is_not_a_number_has_one_pattern_of_bits():
    """The sign of a NaN depends on the processor that made it."""
    values = broken("angle", np.copysign(np.nan, -1.0)).columns["angle"]
    assert values[1].tobytes() == np.float64(np.nan).tobytes()


@pytest.mark.parametrize(
    ("model", "words"),
    [
        ("WRONG_NAME", ["returned no output 'y'", "returned 'z', which is not declared"]),
        ("WRONG_DTYPE", ["'y' is float32, expected float64"]),
        ("WRONG_STATUS", ["no such status: 99"]),
        ("WRONG_CATEGORY", ["'y' has an undeclared category"]),
        ("NO_TUPLE", ["batch must return (outputs, status)"]),
        ("A_LIST", ["'y' is a list, expected an array of float64"]),
    ],
)
def test_a_model_that_breaks_its_contract_is_refused(model, words):
    model = getattr(wrong_models, model)
    x = np.full((4, 2), 0.5)
    with pytest.raises(KernelError) as refused:
        evaluate(model, sample_models.Settings(), x, np.zeros(4, np.uint64))
    assert refused.value.lines == tuple(f"model '{model.name}': {word}" for word in words)


def test_a_model_cannot_write_into_the_design():
    x = np.full((4, 2), 0.5)
    chunk = evaluate(wrong_models.MUTATING, None, x, np.zeros(4, np.uint64))
    assert np.all(x == 0.5)
    assert np.all(chunk.columns["y"] == 0.5)


def test_a_lifetime_that_cannot_be_censored_has_no_flag():
    x = np.array([[1e-10, 1e-4, 0.0]])
    chunk = evaluate(EXPONENTIAL_WEAR, EXPONENTIAL_WEAR.settings(), x, np.zeros(1, np.uint64))
    assert list(chunk.columns) == ["life"]
    assert isinstance(EXPONENTIAL_WEAR.outputs["life"], Output)


def test_of_chunks_that_follow_each_other_the_first_failure_is_kept():
    parts = [linear([0.1, x1], "raise", start) for x1, start in ((0.2, 0), (0.9, 2), (0.95, 4))]
    whole = joined(parts)
    assert whole.failures == {"raised": (3, "ValueError: x1 is above fail_above = 0.8")}
    assert whole.status.tolist() == [0, 0, 0, Status.RAISED, 0, Status.RAISED]
    np.testing.assert_array_equal(
        whole.columns["y"], linear([0.1, 0.2, 0.1, 0.9, 0.1, 0.95], "raise").columns["y"]
    )


def test_a_negative_life_fails_with_a_sentence_and_a_life_of_zero_is_a_life():
    assert list(broken("life", 0.0).status) == [Status.OK, Status.OK]
    chunk = broken("life", -0.5)
    assert list(chunk.status) == [Status.OK, Status.NON_FINITE]
    assert chunk.failures["non-finite"] == (1, "'life' is -0.5: a life cannot be negative")


@pytest.mark.parametrize("output", ["work", "life"])
def test_a_number_whose_sums_may_overflow_fails_with_a_sentence(output):
    assert list(broken(output, 1e300).status) == [Status.OK, Status.OK]
    chunk = broken(output, 1.1e300)
    assert list(chunk.status) == [Status.OK, Status.NON_FINITE]
    assert "1.1e+300: the sum of several numbers beyond 1e+300" in chunk.failures["non-finite"][1]
