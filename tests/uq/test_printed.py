"""Numbers on pages and in figures: minus signs in numbers, hyphens everywhere else."""

import re

import numpy as np
import pytest
from computed import asking, linear, with_output

from uq.result.result import Result
from uq.render.html.page import page
from uq.text.numbers import minus, printed


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("-1.5", "−1.5"),
        ("-2.09 to -1", "−2.09 to −1"),
        ("1e-05 to -2e-07", "1e−05 to −2e−07"),
        ("P(y > -1), [-3, 4]", "P(y > −1), [−3, 4]"),
        ("normal(mean = -1.0, sd = 0.1)", "normal(mean = −1.0, sd = 0.1)"),
        ("uq what-if OUT --set x=-1 --set y=1e-05", "uq what-if OUT --set x=-1 --set y=1e-05"),
        ("beam-lifetime-561, 2026-11-23, period-1-symmetric, x-1", None),
    ],
)
def test_numbers_have_minus_signs_and_names_have_hyphens(text, shown):
    assert minus(text) == (shown or text)


def test_a_unit_stays_with_its_number():
    assert printed("0 % end within 12 days").split(" ") == [
        "0\u00a0%",
        "end",
        "within",
        "12\u00a0days",
    ]
    assert printed("504 pm s⁻¹ of 30 rows").split(" ") == [
        "504\u00a0pm\u00a0s⁻¹",
        "of",
        "30",
        "rows",
    ]
    assert printed("below 0.66 kg m⁻¹") == "below 0.66\u00a0kg\u00a0m⁻¹"
    assert printed("535 N m rad⁻¹, 3 m long").split(" ") == [
        "535\u00a0N\u00a0m\u00a0rad⁻¹,",
        "3\u00a0m",
        "long",
    ]
    assert printed("13 312 rows").split(" ") == ["13\u00a0312", "rows"]
    assert printed("-") == "–"


def test_a_difference_of_symbols_stays_in_one_line():
    assert printed("angle ψ₁ − ψ₂, mean").split(" ") == ["angle", "ψ₁\u00a0−\u00a0ψ₂,", "mean"]


def test_a_report_shows_no_hyphen_for_a_minus_sign():
    ds = linear(samples=200)
    low = with_output(ds, "low", ds["y"].values - 8.0)
    asked = asking(low, outputs=["low"], thresholds={"low": -4.5}, quantiles=[0.05, 0.5])
    text = page(Result(asked), "low.nc")
    shown = re.sub(r"<(script|style|pre)\b.*?</\1>|<[^>]*>", " ", text, flags=re.S)
    assert not re.findall(r"(?<![\w.=-])-\d[\d.]*", shown)
    values = f"−{abs(np.quantile(low['low'], 0.5)):.2f}"
    assert "−4.5" in shown and values in shown
    assert 'data-key="-' in text  # sorting is by plain numbers
