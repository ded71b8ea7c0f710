"""Numbers of fleets as the command line prints them with ``--json``."""

from typing import Any

from uq.assess.fleet import Fleet
from uq.assess.fleet_numbers import Banded
from uq.assess.summary_json import quality_json
from uq.stats import estimate_json


def fleet_json(found: Fleet) -> dict[str, Any]:
    """Return numbers of fleets in plain data."""
    return quality_json(found.weights) | {
        "output": found.output,
        "size": found.size,
        "allow": found.allow,
        "samples": found.samples,
        "integrated": list(found.integrated),
        "first": {"quantiles": {repr(p): _plain(one) for p, one in found.first.items()}},
        "by": {
            repr(time): {"failed": _plain(failed), "at_most_allowed": _plain(at_most)}
            for time, (failed, at_most) in found.by.items()
        },
        "notes": found.notes,
    }


def _plain(one: Banded) -> dict[str, Any]:
    entry = estimate_json.whole(one.estimate) | estimate_json.failed(one.failed)
    for name, end in (("band_low", one.low), ("band_high", one.high)):
        entry[name] = estimate_json.number(end.value)
        entry |= estimate_json.flag(f"{name}_", end, "value")
        for which in ("low", "high"):
            entry[f"{name}_{which}"] = estimate_json.number(getattr(end, which))
            entry |= estimate_json.flag(f"{name}_{which}_", end, which)
        if end.reason:
            entry[f"{name}_reason"] = end.reason
        if end.assumes:
            entry[f"{name}_assumes"] = end.assumes
    return entry
