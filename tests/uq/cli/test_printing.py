"""What is printed: nothing in a text can act on a terminal, and numbers stand in columns."""

import json

import pytest

from uq.cli import printing

HOSTILE = "a\x1b[31m\x9b1m\u202e"


@pytest.mark.parametrize(
    "show",
    [
        lambda: printing.grid([(HOSTILE, "1")]),
        lambda: printing.heading(HOSTILE, HOSTILE),
        lambda: printing.paragraph(HOSTILE),
        lambda: printing.console.print(HOSTILE),
        lambda: printing.print_json({HOSTILE: HOSTILE}),
    ],
    ids=["grid", "heading", "paragraph", "line", "json"],
)
def test_no_text_acts_on_a_terminal(show, capsys, monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    show()
    out = capsys.readouterr().out
    assert "a\\u001b[31m" in out and all(
        character == "\n" or character.isprintable() for character in out
    )


def test_json_with_a_hostile_text_is_json(capsys):
    printing.print_json({HOSTILE: 1.5})
    assert json.loads(capsys.readouterr().out) == {HOSTILE: 1.5}


@pytest.mark.parametrize("width", [60, 80, 120])
def test_names_are_not_split_where_numbers_can_wrap(capsys, monkeypatch, width):
    monkeypatch.setattr(printing.console, "width", width)
    name = "rotational_support_stiffness"
    printing.grid([(name, "0.123", "0.288 to 1.196", "0.743", "0.383 to 1.104")] * 2)
    out = capsys.readouterr().out
    assert out.count(name) == 2 and max(map(len, out.splitlines())) <= width
    cells = [(name, "stated", "104.05", "184.24", "325.45", "0.015")]
    printing.grid(cells, header=("", "", "5 %", "50 %", "95 %", "largest distance"))
    words = capsys.readouterr().out.split()
    assert {name, *cells[0]} <= set(words) or width == 60
    printing.grid([(f"{'word ' * 30}end", "1")])
    assert "end" in capsys.readouterr().out  # what is no name wraps


def test_an_explanation_that_does_not_fit_beside_its_heading_stands_below(capsys, monkeypatch):
    monkeypatch.setattr(printing.console, "width", 60)
    printing.heading("life [days]", "time until either site's gap has grown by the depth")
    printing.heading("life", "short")
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert lines[:2] == ["life [days]", "  time until either site's gap has grown by the depth"]
    assert lines[2:] == ["life  short"]


def test_a_path_longer_than_a_line_can_be_copied(capsys, monkeypatch):
    monkeypatch.setattr(printing.console, "width", 40)
    path = f"/{'long/' * 12}end"
    printing.paragraph(f"ended by the program itself, without a reason; see {path}", indent=2)
    lines = capsys.readouterr().out.splitlines()
    assert lines == ["  ended by the program itself, without a", "  reason; see", f"  {path}"]


def test_numbers_stand_right_and_words_left(capsys):
    printing.grid([("a", "1 %"), ("bcd", "12.5 %"), ("e", "-")], header=("name", "share"))
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert lines == ["  name   share", "  a        1 %", "  bcd   12.5 %", "  e          -"]
