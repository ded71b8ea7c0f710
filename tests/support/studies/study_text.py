"""Study files for the tests of this folder."""

from collections.abc import Mapping
from math import pi
from typing import Any

from uq.text.literals import toml

UNIFORM = {"distribution": "uniform", "lower": -pi, "upper": pi}

ISHIGAMI: dict[str, dict[str, Any]] = {
    "study": {"name": "three-inputs", "model": "ishigami"},
    "design": {"method": "monte-carlo", "samples": 64, "seed": 7},
    "uncertain": {"x1": UNIFORM, "x2": UNIFORM, "x3": UNIFORM},
}


def study_text(changes: Mapping[str, Mapping[str, Any]] | None = None) -> str:
    """Return a study of the Ishigami function with some entries changed; None takes one out."""
    lines = []
    for table in (*ISHIGAMI, *((changes or {}).keys() - ISHIGAMI.keys())):
        entries = {**ISHIGAMI.get(table, {}), **(changes or {}).get(table, {})}
        kept = {key: value for key, value in entries.items() if value is not None}
        lines.append(f"{table} = {toml(kept)}")
    return "\n".join(lines)
