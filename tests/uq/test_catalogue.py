"""What ``uq models NAME`` shows, on wide terminals and on narrow ones."""

import pytest

from uq.cli import catalogue


@pytest.mark.parametrize("name", ["beam", "vibrator", "mole"])
@pytest.mark.parametrize("width", [60, 80])
def test_no_line_of_a_parameter_is_broken(name, width, monkeypatch, capsys):
    monkeypatch.setattr(catalogue.console, "_width", width)
    catalogue.show(catalogue.describe(name))
    told = capsys.readouterr().out.split("Settings")[0].splitlines()
    for parameter in catalogue.find_model(name).nominal:
        start = next(i for i, line in enumerate(told) if line.split()[:1] == [parameter])
        assert told[start + 1].startswith("    ")  # what explains it, not the rest of its line
        assert ("admissible: " in told[start + 1]) == (width == 60)
    assert max(map(len, told)) <= width
