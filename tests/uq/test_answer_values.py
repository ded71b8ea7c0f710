"""What is said of inputs with few values, which rows sorted by an input do not show."""

import numpy as np
import pytest
from computed import asking, computed, study_of, with_output

from uq.conclusions.answer import answer


def graded(samples=1000):
    """Return a value that a grade doubles in some rows: it has most of the variance."""
    x1 = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}
    x2 = {"distribution": "discrete-choice", "values": [0.1, 0.2, 0.3], "weights": [0.6, 0.3, 0.1]}
    tables = {
        "study": {"name": "graded", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": samples, "seed": 1},
        "uncertain": {"x1": x1, "x2": x2 | {"source": "assumed"}},
    }
    ds = computed(study_of(tables))
    level = np.where(ds["x2"].values > 0.25, 4.0, 1.0) * (1 + 0.2 * ds["x1"].values)
    ds = with_output(ds, "level", level)
    return asking(ds, outputs=["level"], thresholds={"level": 3.0}, wanted={"level": "below"})


@pytest.fixture(scope="module")
def found():
    return answer(graded())


def test_an_input_with_few_values_is_ranked(found):
    (contribution,) = found.lead.ranking.contributions
    assert contribution.inputs == ("x2",) and contribution.indices[0].value > 0.95
    assert found.lead.ranking.with_effect.endswith("More raises it.")  # it has no small changes
    assert [one.rule for one in found.advice][0] == "measure" and found.advice[0].inputs == ("x2",)


def test_the_probability_of_an_event_is_that_at_each_value(found):
    (event,) = found.lead.events
    assert event.decided_by == (
        "Decided most by x2: from 0 % where it is below 0.25 to 100 % where it is above 0.25."
    )
    assert event.limited == "Fewer than 5 % exceed 3 m where x2 is at most 0.25."
