"""Sensitivity indices as the command line prints them with ``--json``."""

from math import isfinite
from typing import Any

from uq.assess.sensitivities import Sensitivities, TargetIndices
from uq.stats.estimate_json import numbers


def sensitivity_json(sensitivities: Sensitivities) -> dict[str, Any]:
    """Return indices in plain data, as ``uq sensitivity --json`` prints them."""
    return {
        "method": sensitivities.method,
        "rows_used": sensitivities.rows_used,
        "groups_dropped": sensitivities.groups_dropped,
        "outputs": {name: _plain_target(target) for name, target in sensitivities.targets.items()},
    }


def _plain_target(target: TargetIndices) -> dict[str, Any]:
    entry: dict[str, Any] = {"rows_used": target.rows_used, "groups_dropped": target.groups_dropped}
    if target.refused:
        return entry | {"refused": target.refused}
    for kind, values in target.indices.values.items():
        entry[kind.key] = {label: numbers(index) for label, index in values.items()}
    if target.indices.noise is not None:
        entry["noise"] = numbers(target.indices.noise)
    if target.indices.by_correlation:
        entry["by_correlation"] = list(target.indices.by_correlation)
    if target.indices.nulls:
        entry["dummy"] = {
            key: number
            for kind, null in target.indices.nulls.items()
            for key, number in ((kind.key, null.limit), (f"{kind.key}_any", null.largest))
            if isfinite(number)
        }
    return entry | {"notes": list(target.indices.notes)}
