"""What a stream writes whose encoding lacks a character."""

import io
import sys

import pytest

from uq.cli import streams

WRITTEN = [
    ("ascii", "s⁻¹ m² µm μm ≥ ≤ φ₁ Ω é –", "s-1 m2 um um >= <= phi1 Omega e -"),
    ("ascii", "3.2 × 10⁻⁵", "3.2 x 10^-5"),
    ("cp1252", "s⁻¹ m² µm ≥ é – 中", "s-1 m² µm >= é – ?"),
    ("utf-8", "s⁻¹ ≥", "s⁻¹ ≥"),
]


@pytest.mark.parametrize(("encoding", "text", "expected"), WRITTEN)
def test_a_character_that_cannot_be_encoded_is_written_readably(encoding, text, expected):
    stream = io.BytesIO()
    with io.TextIOWrapper(stream, encoding, streams.HANDLER, write_through=True) as written:
        written.write(text)
        assert stream.getvalue().decode(encoding) == expected


def test_the_command_line_writes_to_a_narrow_stream(uq, monkeypatch, tmp_path):
    monkeypatch.setattr("sys.stdout", open(tmp_path / "out", "w", encoding="ascii"))
    assert uq("models", "beam").code == 0
    sys.stdout.close()
    assert "N2 Hz-1" in (tmp_path / "out").read_text()
