"""Symbols in figures are formulas, and other text is left alone."""

import pytest
from computed import linear
from drawn import words as written_in
from matplotlib.mathtext import MathTextParser

from models import beam, mole, vibrator
from uq import plots
from uq.render.figures.words import formula, labelled, typeset


@pytest.mark.parametrize(
    ("symbol", "written"),
    [
        ("k_tra", r"$k_{\mathrm{tra}}$"),
        ("omega_s1", r"$\omega_{s1}$"),
        ("rho A", r"$\rho\,A$"),
        ("Omega/(2 pi)", r"$\Omega/(2\,\pi)$"),
        ("psi_1(0)", r"$\psi_{1}(0)$"),
        ("X0", "$X_{0}$"),
        ("k_psi", r"$k_{\psi}$"),
        ("a__b", "a__b"),
        ("gap_at_stop_2", "gap_at_stop_2"),
        ("$^{", r"\$^{"),
    ],
)
def test_a_symbol_is_written_with_greek_letters_and_subscripts(symbol, written):
    assert formula(symbol) == written


def test_a_name_of_several_words_is_no_symbol_of_its_own():
    ds = linear(samples=20)
    ds["x1"].attrs |= {"long_name": "gap at stop 2", "symbol": "gap_at_stop_2"}
    assert labelled(ds["x1"]) == "Gap at stop 2"
    figure = plots.scatter(ds, "y")
    figure.draw_without_rendering()
    assert "_at_" not in written_in(figure)


def test_only_symbols_in_text_are_formulas():
    assert typeset("angle psi_1 - psi_2, mean") == r"angle $\psi_{1}$ − $\psi_{2}$, mean"
    for words in ("it must be above", "numerical error", "period of a pin", "locked-pi"):
        assert typeset(words) == words


@pytest.mark.parametrize("model", [beam.MODEL, mole.MODEL, vibrator.MODEL], ids=lambda m: m.name)
def test_the_symbols_of_the_machines_can_be_typeset(model):
    parse = MathTextParser("agg").parse
    for name in model.parameter_names:
        declared = model.parameter(name)
        text = formula(declared.symbol)
        assert text.startswith("$"), declared.symbol
        parse(f"{text} {typeset(declared.meaning)}")
    for output in model.outputs.values():
        parse(f"$x$ {typeset(output.meaning)}")
