"""Summary of a posterior: inputs, remaining lives, information gains and warnings."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any
from unicodedata import normalize

import numpy as np

from uq.assess.fact import Fact
from uq.assess.summary_facts import quality_facts
from uq.assess.weighted_mixture import WeightedMixture
from uq.errors import InputError
from uq.learning.inspections import Inspection
from uq.learning.posterior import InformationGain, Posterior, information_gains, posterior
from uq.learning.posterior_checks import STRANGE, prior_predictive_p_value
from uq.learning.posterior_inputs import (
    Confounded,
    InputLearnt,
    PosteriorMoments,
    confounded,
    inputs_learnt,
    quantiles,
)
from uq.learning.posterior_result import as_table, inspections_of, prior_of, unit_quality
from uq.learning.remaining_life import ANY, Remaining, over_shared, remaining
from uq.result.result import AnyResult, Result
from uq.result.weights import MODEL_ERROR
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.stats.importance_weights import ImportanceWeights, effective_rows
from uq.stats.weighted_means import moments_of_rows
from uq.text.numbers import percent


@dataclass(frozen=True)
class Learnt:
    """Summary of a posterior.

    Attributes
    ----------
    inspections : list of Inspection
    worst : ImportanceWeights
        The least reliable weights, among all inspected units and the units never inspected.
    inputs : list of InputLearnt
    confounded : list of Confounded
    lives : list of Remaining
    taught : list of InformationGain
    strangeness : float
        Prior-predictive p-value of the inspections (Box 1980).
    notes : list of str
        Warnings.
    """

    inspections: list[Inspection]
    worst: ImportanceWeights
    inputs: list[InputLearnt]
    confounded: list[Confounded]
    lives: list[Remaining]
    taught: list[InformationGain]
    strangeness: float
    notes: list[str]


def learnt(result: AnyResult, by: Sequence[float] = ()) -> Learnt:
    """Return the summary of a result of `uq.update`.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
    by : sequence of float
        Times from the start of a life, in its unit, at which to estimate the failure probability.

    Raises
    ------
    InputError
        When the result has not been updated, or a time is negative or not finite.
    """
    result = Result.of(result)
    if not result.has_weights:
        raise InputError("this result has not been updated with inspections: see 'uq update'")
    quality, inspections = unit_quality(result), inspections_of(result)
    cv = float(result.dataset.attrs[MODEL_ERROR])
    rows = prior_of(result).independent
    updated = posterior(rows, inspections, cv)
    p_value = prior_predictive_p_value(updated, int(result.dataset.attrs["seed"]), cv)
    return Learnt(
        inspections,
        min(quality, key=lambda weights: weights.effective),
        list(inputs_learnt(result)),
        confounded(result),
        list(remaining(result, by)),
        list(information_gains(updated)),
        p_value,
        [
            *_warnings(p_value),
            *_alike(list(updated.units)),
            *updated.not_integrated,
            *_interpolated(updated),
            *filter(None, [updated.only_inspected]),
        ],
    )


def _warnings(p_value: float) -> Iterator[str]:
    if p_value < STRANGE:
        yield (
            f"Warning: the inspections contradict the prior (p-value {percent(p_value)}):"
            " a law, the model (--model-error) or an inspection may be wrong."
        )


def _alike(labels: Sequence[str]) -> Iterator[str]:
    """Yield a warning for each pair of labels that may denote the same unit."""
    seen: dict[str, str] = {}
    for label in labels:
        letters = "".join(normalize("NFKC", label).casefold().split())
        if (other := seen.setdefault(letters, label)) != label:
            yield f"Warning: '{other}' and '{label}' are treated as two units."


def _interpolated(updated: Posterior) -> Iterator[str]:
    """Yield warnings on the accuracy of depths interpolated between the tabulated ones."""
    observables = updated.likelihoods.observables.values()
    for observable in {observable.name: observable for observable in observables}.values():
        errors = observable.depths.error() if observable.depths is not None else np.empty(0)
        if np.isfinite(errors).any():
            most = percent(float(np.nanquantile(errors, 0.9)))
            yield (
                f"{observable.name} at a time is interpolated; without one of the declared depths"
                f" it changes by up to {most} in nine of ten rows."
            )


def learnt_facts(summary: Learnt) -> Fact:
    """Return the summary of a posterior as a tree of facts.

    Returns
    -------
    Fact
        ``effective_rows``, ``pareto_k``; ``inputs``: name -> ``prior`` and ``posterior``, each with
        ``mean``, ``sd`` (of the posterior with intervals, ``mean_low``, ..., and ``mean_reason``
        where it is missing) and ``quantiles``; of a unit as ``NAME[unit=LABEL]``; ``confounded``:
        pairs with their rank correlation; ``taught``: the information gain of each inspection in
        ``bits``, given all others; ``strangeness``: prior-predictive p-value of the inspections;
        ``notes``; ``units``: label -> life -> ``units`` (of all
        times), ``seen`` (when it was last seen running), ``runs``, ``remaining`` (quantiles from
        then on), ``by`` (probability of failure by a time), ``effective_rows``; ``uninspected``:
        the same for units never inspected, with ``over_shared`` beside a probability, where
        available: its 2.5 and 97.5 % quantiles over the shared inputs.
    """
    fact = partial(Fact, notes=tuple(summary.notes))

    def spread(moments: PosteriorMoments) -> Fact:
        points = {repr(p): value for p, value in moments.quantiles.items()}
        members: dict[str, Any] = {}
        for name, estimate in (("mean", moments.mean), ("sd", moments.sd)):
            members[name] = estimate_json.number(estimate.value)
            members |= {
                f"{name}_{end}": value for end, value in estimate_json.ends(estimate).items()
            }
            members |= {f"{name}_reason": estimate.reason} if estimate.reason else {}
        members["quantiles"] = fact(points, (posterior, inputs_learnt, quantiles))
        return fact(members, (posterior, inputs_learnt, moments_of_rows))

    def ended(remaining_life: Remaining, time: float, probability: Estimate) -> dict[str, Any]:
        members: dict[str, Any] = estimate_json.whole(probability)
        if points := remaining_life.over_shared.get(time, {}):
            by_share = {repr(p): x for p, x in points.items()}
            members["over_shared"] = fact(by_share, (posterior, remaining, over_shared))
        return members

    def life(remaining_life: Remaining) -> Fact:
        members = {
            "units": remaining_life.units,
            "seen": remaining_life.seen,
            "runs": estimate_json.whole(remaining_life.runs),
            "remaining": {
                repr(p): estimate_json.whole(quantile)
                for p, quantile in remaining_life.life.items()
            },
            "by": {
                repr(time): ended(remaining_life, time, probability)
                for time, probability in remaining_life.by.items()
            },
            "effective_rows": fact(
                remaining_life.effective_rows, (posterior, remaining, effective_rows)
            ),
        }
        return fact(members, (posterior, remaining, WeightedMixture))

    units: dict[str, dict[str, Any]] = {}
    for remaining_life in summary.lives:
        units.setdefault(remaining_life.unit, {})[remaining_life.output] = life(remaining_life)
    quality = {
        name: fact(number.members, (posterior, *number.by))
        for name, number in quality_facts(summary.worst).items()
    }
    members = quality | {
        "inspections": len(summary.inspections),
        "inputs": {
            posterior_input.name: {
                "units": posterior_input.units,
                "prior": spread(posterior_input.prior),
                "posterior": spread(posterior_input.posterior),
            }
            for posterior_input in summary.inputs
        },
        "confounded": fact(
            [
                {"inputs": [pair.first, pair.second], "correlation": pair.correlation}
                for pair in summary.confounded
            ],
            (posterior, confounded),
        ),
        "taught": fact(
            [as_table(gain.inspection) | {"bits": gain.bits} for gain in summary.taught],
            (posterior, information_gains),
        ),
        "strangeness": fact(summary.strangeness, (posterior, prior_predictive_p_value)),
        "notes": summary.notes,
        "uninspected": units.pop(ANY, {}),
        "units": units,
    }
    return fact(members, (posterior,))
