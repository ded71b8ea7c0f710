import tomllib
from math import isnan

from hypothesis import given
from hypothesis import strategies as st

from uq.text.literals import shown, toml

TEXTS = st.text(st.characters(exclude_categories=["Cs"]))
VALUES = st.recursive(
    st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False) | TEXTS,
    lambda inner: st.lists(inner) | st.dictionaries(TEXTS, inner),
)


@given(VALUES)
def test_a_literal_reads_back_to_the_last_bit(value):
    text = toml(value)
    assert "\n" not in text
    back = tomllib.loads(f"value = {text}")["value"]
    assert back == value
    assert type(back) is type(value)


def test_a_literal_may_be_no_number():
    assert isnan(tomllib.loads(f"value = {toml(float('nan'))}")["value"])


def test_what_is_shown_is_cut():
    assert shown([1.0] * 1000, width=20) == "[1.0, 1.0, 1.0, 1..."
    assert shown(10**5000) == "..."
