"""Sensitivity indices as the command line prints them with ``--json``."""

from math import isfinite
from typing import Any

from uq.assess.sensitivities import Sensitivities, TargetIndices
from uq.stats.estimate_json import numbers


def sensitivity_json(found: Sensitivities) -> dict[str, Any]:
    """Return indices in plain data, as ``uq sensitivity --json`` prints them."""
    return {
        "method": found.method,
        "rows_used": found.rows_used,
        "groups_dropped": found.groups_dropped,
        "outputs": {name: _plain_target(one) for name, one in found.targets.items()},
    }


def _plain_target(one: TargetIndices) -> dict[str, Any]:
    entry: dict[str, Any] = {"rows_used": one.rows_used, "groups_dropped": one.groups_dropped}
    if one.refused:
        return entry | {"refused": one.refused}
    for kind, values in one.indices.values.items():
        entry[kind.key] = {label: numbers(index) for label, index in values.items()}
    if one.indices.noise is not None:
        entry["noise"] = numbers(one.indices.noise)
    if one.indices.by_correlation:
        entry["by_correlation"] = list(one.indices.by_correlation)
    if one.indices.nulls:
        entry["dummy"] = {
            key: number
            for kind, null in one.indices.nulls.items()
            for key, number in ((kind.key, null.limit), (f"{kind.key}_any", null.largest))
            if isfinite(number)
        }
    return entry | {"notes": list(one.indices.notes)}
