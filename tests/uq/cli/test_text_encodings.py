"""Byte-order marks and CRLF change nothing; text for a narrow encoding stays readable."""

import io
import sys
from codecs import BOM_UTF8

import pytest
from command_line import strict_json
from own_machines import run_program

from uq.cli.printing import print_json
from uq.cli.streams import _watched
from uq.machines.program import code_of_program


@pytest.mark.parametrize(
    ("encoding", "text"),
    [
        ("ascii", "s-1 >= um lambda Psi2 3 - 1 ?"),
        ("cp1252", "s-1 >= µm lambda Psi2 3 - 1 ?"),
        ("utf-8", "s⁻¹ ≥ µm λ Ψ₂ 3 \N{MINUS SIGN} 1 漢"),
    ],
)
def test_what_cannot_be_encoded_is_replaced_readably(encoding, text):
    bytes_ = io.BytesIO()
    stream = _watched(io.TextIOWrapper(bytes_, encoding, "strict"), 1)
    stream.write("s⁻¹ ≥ µm λ Ψ₂ 3 \N{MINUS SIGN} 1 漢")
    stream.flush()
    assert bytes_.getvalue().decode(encoding) == text


def test_json_for_a_narrow_encoding_keeps_its_text(monkeypatch):
    bytes_ = io.BytesIO()
    monkeypatch.setattr("sys.stdout", io.TextIOWrapper(bytes_, "ascii", "strict"))
    print_json({"unit": "µm ≥"})
    sys.stdout.flush()
    assert strict_json(bytes_.getvalue().decode("ascii")) == {"unit": "µm ≥"}


def test_an_editor_of_windows_changes_no_row_and_no_identity(uq, folder, write_program):
    write_program()
    _, plain = run_program(uq)
    code = code_of_program(folder / "machine.toml")
    for name in ("machine.toml", "own.toml"):
        text = (folder / name).read_bytes().replace(b"\n", b"\r\n")
        (folder / name).write_bytes(BOM_UTF8 + text)
    (folder / "deck").write_bytes(BOM_UTF8 + (folder / "deck").read_bytes())
    ended, marked = run_program(uq, "--fresh")
    assert ended.err.count("Traceback") == 0 and marked is not None
    assert marked["life"].identical(plain["life"]) and marked["status"].identical(plain["status"])
    assert code_of_program(folder / "machine.toml") == code
