"""Sensitivity indices as a tree of facts."""

from functools import partial
from math import isfinite
from typing import Any

from uq.assess.fact import Fact
from uq.assess.sensitivities import Sensitivities, TargetIndices
from uq.indices.methods import indices_of
from uq.stats.estimate_json import numbers


def sensitivity_facts(sensitivities: Sensitivities) -> Fact:
    """Return the indices of all targets."""
    method = sensitivities.method
    return Fact(
        {
            "method": method,
            "rows_used": sensitivities.rows_used,
            "groups_dropped": sensitivities.groups_dropped,
            "outputs": {
                name: _target(target, method) for name, target in sensitivities.targets.items()
            },
        },
        (partial(indices_of, method, ""),),
        rows=sensitivities.rows,
    )


def _target(target: TargetIndices, method: str) -> Fact:
    indices, notes = target.indices, tuple(target.indices.notes)
    members: dict[str, Any] = {
        "rows_used": target.rows_used,
        "groups_dropped": target.groups_dropped,
    }
    if target.refused:
        return Fact(members | {"refused": target.refused})
    for kind, values in indices.values.items():
        by_input = {label: numbers(index) for label, index in values.items()}
        members[kind.key] = Fact(by_input, (partial(indices_of, method, kind.key),), notes=notes)
    if indices.noise is not None:
        members["noise"] = numbers(indices.noise)
    if indices.by_correlation:
        members["by_correlation"] = list(indices.by_correlation)
    if indices.nulls:
        members["dummy"] = {
            key: number
            for kind, null in indices.nulls.items()
            for key, number in ((kind.key, null.limit), (f"{kind.key}_any", null.largest))
            if isfinite(number)
        }
    return Fact(members | {"notes": list(notes)}, notes=notes)
