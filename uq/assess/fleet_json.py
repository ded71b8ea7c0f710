"""Numbers of fleets as the command line prints them with ``--json``."""

from typing import Any

from uq.assess.fleet import Fleet
from uq.assess.fleet_numbers import Banded
from uq.assess.summary_json import quality_json
from uq.stats import estimate_json


def fleet_json(fleet: Fleet) -> dict[str, Any]:
    """Return numbers of fleets in plain data."""
    return quality_json(fleet.weights) | {
        "output": fleet.output,
        "size": fleet.size,
        "allow": fleet.allow,
        "samples": fleet.samples,
        "integrated": list(fleet.integrated),
        "first": {"quantiles": {repr(p): _plain(banded) for p, banded in fleet.first.items()}},
        "by": {
            repr(time): {"failed": _plain(failed), "at_most_allowed": _plain(at_most)}
            for time, (failed, at_most) in fleet.by.items()
        },
        "notes": fleet.notes,
    }


def _plain(banded: Banded) -> dict[str, Any]:
    entry = estimate_json.whole(banded.estimate) | estimate_json.failed(banded.failed)
    for name, end in (("band_low", banded.low), ("band_high", banded.high)):
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
