"""Runs that stop at an interval that misses: at most 5 %, whatever half-width is required."""

import pytest

from benchmarks.coverage.parts import PARTS

BY_CHANCE = 0.01
"""By which the worst of many half-widths may seem worse in 2,000 repetitions."""


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in PARTS if name.startswith("stopped")])
def test_at_most_5_percent_of_stops_are_wrong(name):
    for line in PARTS[name].count(2000):
        print(f"\n{line.problem}: {line.what}: {line.coverage[0]:.1%}", end="")
        assert line.given > 0.99 * line.repetitions, line
        assert line.coverage[0] >= 0.95 - BY_CHANCE, line
