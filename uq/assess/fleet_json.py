"""Numbers of fleets as a tree of facts."""

from dataclasses import replace
from typing import Any

from uq.assess.fact import Fact
from uq.assess.fleet import Fleet, fleet
from uq.assess.fleet_numbers import Banded
from uq.assess.population import Population
from uq.assess.summary_json import quality_facts
from uq.stats import estimate_json


def fleet_facts(fleets: Fleet) -> Fact:
    """Return the numbers of fleets of one size."""
    notes = tuple(fleets.notes)
    quality = {
        name: replace(fact, notes=notes) for name, fact in quality_facts(fleets.weights).items()
    }
    numbers: dict[str, Any] = {
        "output": fleets.output,
        "size": fleets.size,
        "allow": fleets.allow,
        "samples": fleets.samples,
        "integrated": list(fleets.integrated),
        "first": {"quantiles": {repr(p): _banded(banded) for p, banded in fleets.first.items()}},
        "by": {
            repr(time): {"failed": _banded(failed), "at_most_allowed": _banded(at_most)}
            for time, (failed, at_most) in fleets.by.items()
        },
        "notes": fleets.notes,
    }
    return Fact(quality | numbers, (fleet, Population), notes=notes)


def _banded(banded: Banded) -> dict[str, Any]:
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
