"""One quantity has one number: in JSON, tables, the answer and the page."""

import re

import numpy as np
import pytest
from answered import lifetime
from computed import asking, kinds, summarised

from uq.assess.answer.answer import answer
from uq.assess.sensitivities import sensitivities
from uq.assess.sensitivity_table import sensitivity_facts
from uq.render.html.page import page
from uq.result.result import Result


@pytest.fixture
def life(monkeypatch):
    """A life of 1,000 rows, as if these were too many to rank inputs by all of them."""
    monkeypatch.setattr("uq.result.nesting.RANKED", 400)
    return asking(lifetime()[0], tolerance={"coverage": 0.95, "confidence": 0.95})


def test_a_share_is_the_same_in_table_answer_and_json(life, no_other_figures):
    table = sensitivity_facts(sensitivities(Result(life))).json["outputs"]["log(life)"]["S1"]
    ranking = answer(life).fact.json["quantities"]["life"]["ranking"]
    shares = {
        k: v for contribution in ranking["contributions"] for k, v in contribution["inputs"].items()
    }
    assert shares["rate"] == table["rate"]
    percent = [round(100 * table["rate"][end]) for end in ("value", "low", "high")]
    text = "{} % ({} to {} %)".format(*percent)
    assert f"Rate contributes most: {text}" in ranking["sentence"]
    text_of_page = re.sub(r"<[^>]+>", "", page(Result(life), "life.nc")).replace("\xa0", " ")
    assert text in text_of_page and f"{table['rate']['value']:.3f}" in text_of_page
    for other in re.findall(r"[Rr]ate[^.]{0,40}contributes most: (\d+ %[^)]*\))", text_of_page):
        assert other == text


def test_a_bound_is_the_same_in_table_and_answer(life):
    tolerance_bound = answer(life).fact.json["quantities"]["life"]["promise"]
    assert tolerance_bound["lower"] == summarised(life)["outputs"]["life"]["tolerance"]["lower"]
    quantile = summarised(life)["outputs"]["life"]["quantiles"]["0.05"]
    for advice in answer(life).advice:
        for remedy in advice.effects:
            if remedy.bound_sentence:  # the end of an interval is not called a bound
                assert "With 95 % confidence" not in remedy.bound_sentence
                assert remedy.before.low == pytest.approx(quantile["low"], rel=1e-12)


def test_the_bound_of_an_angle_is_that_of_its_magnitude_in_the_table_too():
    ds = kinds(samples=400, analysis={"outputs": ["angle"]})
    ds = asking(ds, tolerance={"coverage": 0.95, "confidence": 0.95}, thresholds={"angle": 0.5})
    bounds = summarised(ds)["outputs"]["angle"]["tolerance"]
    tolerance_bound = answer(ds).fact.json["quantities"]["angle"]["promise"]
    assert np.isfinite(tolerance_bound["upper"]) and tolerance_bound["upper"] == bounds["magnitude"]
