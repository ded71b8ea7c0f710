"""Which inputs an output's scatter comes from: every method, for a result as a whole."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.designs.registry import DESIGNS, FOR_DEPENDENT_INPUTS
from uq.errors import InputError, nearest
from uq.methods.fast import curves, fast_indices
from uq.methods.few_rows import few_hits
from uq.methods.given_data import given_data_indices
from uq.methods.groups import whole_groups
from uq.indices.independent_inputs import independent_inputs, notes_on_inputs, why_dependent
from uq.methods.morris import morris_indices, trajectories
from uq.methods.shapley import paths, shapley_indices
from uq.methods.sobol import crossed, sobol_indices
from uq.indices.targets import (
    Index,
    Indices,
    RefusedError,
    Target,
    all_targets,
    category_targets,
    lightened,
    split_name,
    targets,
    with_tail_note,
)
from uq.rows.elements import analysis_of, elements_of, named_elements, shown_outputs
from uq.rows.in_regime import within_regime
from uq.tails import lacks_variance

_GROUPED: dict[str, tuple[Callable[..., Any], Callable[..., Indices]]] = {
    "sobol": (crossed, sobol_indices),
    "morris": (trajectories, morris_indices),
    "shapley": (paths, shapley_indices),
    "fast": (curves, fast_indices),
}
"""Methods whose rows belong together: what finds them in a result, and the estimate from them."""


_AT_ONE_SEED = (
    "shares of the variance at one seed, to which noise that does not depend on the inputs adds"
    " nothing"
)
_WITH_NOISE = {
    "sobol": (
        "the model is random, and the rows of a group share a seed: S1 holds no noise, ST holds"
        " what noise does together with the input, and 'noise' is the share of the variance that"
        " remains once all inputs are known"
    ),
    "morris": "the model is random, and the rows of a trajectory share a seed: no effect is noise",
    "shapley": f"the model is random, and the rows of a path share a seed: {_AT_ONE_SEED}",
    "fast": f"the model is random, and the points of a curve share a seed: {_AT_ONE_SEED}",
}
"""What a method whose rows share seeds makes of noise."""


SCALE_FREE = ("delta", "pawn", "regional")
"""Methods that compare distributions: no increasing function of an output changes what they say."""

_OF_VARIANCE = ("sobol", "shapley", "fast", "rbd-fast", "hdmr")
"""Methods whose indices are shares of the variance."""


def methods(ds: xr.Dataset, dependent: bool | None = None) -> tuple[str, ...]:
    """Return the methods that the study asks for, or else the first that its design can feed.

    Of dependent inputs, one that does not suppose them to be independent.
    """
    dependent = bool(why_dependent(ds)) if dependent is None else dependent
    feeds = DESIGNS[ds.attrs["design"]].feeds_with(dependent)
    asked = analysis_of(ds).sensitivity
    return tuple(name for name in asked if name in feeds) or feeds[:1] or asked


def sensitivities(
    ds: xr.Dataset,
    method: str | None = None,
    output: str | Sequence[str] | None = None,
    regime: str | None = None,
) -> dict[str, Any]:
    """Estimate sensitivity indices as plain data, ready for JSON.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    method : str, optional
        By default the first of `methods`.
    output : str or sequence of str, optional
        An output, one element of it, or one of the names that this function returns; by default
        the outputs that the study wants to see. Of a category, such as the regime, the targets
        are ``P(regime=label)``: whether a row is in each that occurs. Of a lifetime they are its
        logarithm, or its rank where rows never end or are censored, and ``P(life<t)``; its rate
        1/T is there as ``rate(life)``. A value whose tail is heavy stands by default as its
        logarithm or rank, and under its own name as it is. Of several names those are left out
        that mean nothing here.
    regime : str, optional
        Use the rows in this regime only. Among them the inputs depend on each other.

    Returns
    -------
    dict
        ``method``; ``rows_used`` and ``groups_dropped``, where a group (a row, in designs without
        groups) counts as dropped if any output with indices lacks it; ``outputs``: name -> ``S1``
        and the like -> parameter -> ``value``, ``low``, ``high``. Each output has its own counts
        and ``notes``, and ``dummy`` where the method has no intervals; one without indices has
        ``refused``, a sentence. From a crossed design of a random model each has ``noise``, with
        ``value``, ``low``, ``high``: the share of the variance that the inputs leave open.

    Raises
    ------
    InputError
        When the design cannot feed the method, or there is no such output.
    """
    if regime is not None:
        ds = within_regime(ds, regime)
    name, found = _estimate(ds, method, output, within=regime is not None)
    outputs = {}
    for one in found:
        entry: dict[str, Any] = {"rows_used": one.rows_used, "groups_dropped": one.dropped}
        if isinstance(one.indices, str):
            outputs[one.target.name] = entry | {"refused": one.indices}
            continue
        for kind, values in one.indices.values.items():
            entry[kind] = {label: _plain(index) for label, index in values.items()}
        if one.indices.noise is not None:
            entry["noise"] = _plain(one.indices.noise)
        if one.indices.dummy:
            entry["dummy"] = dict(one.indices.dummy)
        outputs[one.target.name] = entry | {"notes": list(one.indices.notes)}
    used = [one.whole for one in found if not isinstance(one.indices, str)]
    whole = np.logical_and.reduce(used or [one.whole for one in found])
    return {
        "method": name,
        "rows_used": int(whole.sum()) * (ds.sizes["sample"] // whole.size),
        "groups_dropped": int((~whole).sum()),
        "outputs": outputs,
    }


def sensitivity(ds: xr.Dataset, method: str | None = None) -> xr.Dataset:
    """Estimate sensitivity indices as arrays.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    method : str, optional
        By default the first of `methods`.

    Returns
    -------
    xarray.Dataset
        Each index over ``output`` and ``parameter`` (``S2`` over ``pair``), with ``_low`` and
        ``_high``; NaN where there is none. ``dummy_<index>``, ``groups_dropped`` and ``refused``
        (why there are no indices, or "") over ``output``; so is ``noise``, with ``_low`` and
        ``_high``, where a model is random.

    Raises
    ------
    InputError
        When the design cannot feed the method.

    Examples
    --------
    >>> found = uq.sensitivity(uq.run("studies/ishigami.toml"))
    >>> found["ST"].sel(output="y").to_series().round(2).to_dict()  # 0.558, 0.442, 0.244
    {'x1': 0.56, 'x2': 0.45, 'x3': 0.25}
    """
    name, found = _estimate(ds, method, None)
    estimated = [one.indices for one in found if not isinstance(one.indices, str)]
    data: dict[str, Any] = {
        "groups_dropped": ("output", [one.dropped for one in found]),
        "refused": (
            "output",
            [one.indices if isinstance(one.indices, str) else "" for one in found],
        ),
    }
    coords: dict[str, Any] = {"output": [one.target.name for one in found]}
    # Those of a quantile have other names for a lifetime.
    kinds = {kind: labels for one in estimated for kind, labels in one.values.items()}
    for kind, labels in kinds.items():
        dim = "pair" if kind == "S2" else "parameter"
        coords[dim] = list(labels)
        table = np.array([_row(one, kind, list(labels)) for one in found])
        for i, end in enumerate(("", "_low", "_high")):
            data[f"{kind}{end}"] = (("output", dim), table[:, :, i])
    if any(one.noise for one in estimated):
        shares = np.array([_noise(one) for one in found])
        for i, end in enumerate(("", "_low", "_high")):
            data[f"noise{end}"] = ("output", shares[:, i])
    for kind in {kind: None for one in estimated for kind in one.dummy}:
        data[f"dummy_{kind}"] = ("output", [_dummy(one, kind) for one in found])
    return xr.Dataset(data, coords, {"method": name})


class _Found(NamedTuple):
    """What became of a target: its indices, or the sentence why there are none."""

    target: Target
    indices: Indices | str
    whole: NDArray[np.bool_]
    rows_per_group: int

    @property
    def rows_used(self) -> int:
        return int(self.whole.sum()) * self.rows_per_group

    @property
    def dropped(self) -> int:
        return int((~self.whole).sum())


def _estimate(
    ds: xr.Dataset, method: str | None, output: str | Sequence[str] | None, within: bool = False
) -> tuple[str, list[_Found]]:
    why = "within a regime the inputs depend on each other" if within else why_dependent(ds)
    method = method or [*methods(ds, bool(why)), *DESIGNS[ds.attrs["design"]].feeds][0]
    _check_method(ds, method, why)
    asked = analysis_of(ds).quantiles
    find, estimate = _GROUPED.get(method, (None, None))
    design = find(ds) if find else None
    inputs, notes = independent_inputs(ds), tuple(notes_on_inputs(ds))
    if ds.attrs.get("random") and method in _WITH_NOISE:
        notes = (*notes, _WITH_NOISE[method])
    found = []
    for target in _chosen(ds, method, output):
        indices: Indices | str
        try:
            if target.refused:
                raise RefusedError(target.refused)
            if method in _OF_VARIANCE and not target.event and lacks_variance(target.values):
                raise RefusedError(_no_variance(target))
            few = few_hits(ds, target)
            if estimate is None:
                quantiles = _quantiles(target, asked)
                indices = given_data_indices(method, inputs, target.values, quantiles)
            else:
                indices = estimate(design, target.values)
            indices = indices._replace(notes=target.notes + few + indices.notes + notes)
        except RefusedError as refusal:
            indices = str(refusal)
        alone = np.arange(target.values.size)[:, None]
        whole = whole_groups(target.values, alone if design is None else design.order)
        found.append(_Found(target, indices, whole, ds.sizes["sample"] // whole.size))
    return method, found


def _no_variance(target: Target) -> str:
    name = target.element.name if target.element else target.name
    return (
        f"the tail of {target.name} is too heavy for a variance to apportion; ask for"
        f" log({name}), where all rows are positive, or rank({name})"
    )


def _quantiles(target: Target, asked: tuple[float, ...]) -> dict[str, float]:
    """Return what quantiles of a target are called: B10 of a life is where its rate is high."""
    if target.element is not None and target.element.kind == "lifetime":
        return {"B10": 0.9 if target.name.startswith("rate(") else 0.1, "B50": 0.5}
    return {f"Q{probability!r}": probability for probability in asked}


def _check_method(ds: xr.Dataset, method: str, dependent: str) -> None:
    design = ds.attrs["design"]
    feeds = DESIGNS[design].feeds_with(bool(dependent))
    if method in feeds:
        return
    if method in DESIGNS[design].feeds:
        raise InputError(
            f"method '{method}' supposes independent inputs, but {dependent}"
            f" (methods that do not: {', '.join(FOR_DEPENDENT_INPUTS)})"
        )
    able = [name for name, other in DESIGNS.items() if method in other.feeds]
    if not able:
        known = sorted({name for other in DESIGNS.values() for name in other.feeds})
        raise InputError(
            f"no such method '{method}'{nearest(method, known)} (allowed: {', '.join(known)})"
        )
    raise InputError(
        f"method '{method}' needs a design of {' or '.join(able)}; this result is of design"
        f" '{design}', which feeds {', '.join(feeds)}"
    )


def _chosen(ds: xr.Dataset, method: str, output: str | Sequence[str] | None) -> list[Target]:
    """Return the targets that a user means, all that suit the method or by name."""
    if output is None:
        found = [
            target if method in SCALE_FREE else lightened(target)
            for name in shown_outputs(ds, analysis_of(ds))
            for target in _targets(ds, name)
            if target.event or method != "regional"
            if not target.event or method != "quantile"
        ]
        if not found and method == "regional":
            raise InputError(
                "'regional' needs an event: a category, or a time of a lifetime in [analysis]"
                " thresholds"
            )
        if not found:
            raise InputError("none of the outputs is a number: there is nothing to apportion")
        return found
    names = [output] if isinstance(output, str) else output
    found = [target for name in names for target in _named(ds, name)]
    if not found and isinstance(output, str):
        _, inside, _ = split_name(output)
        if output == inside:
            raise InputError(f"no row has a {output}: there is nothing to apportion")
        names = [target.name for target in _targets(ds, _output_in(inside), every=True)]
        raise InputError(f"no such output '{output}'{nearest(output, names)}")
    return found if method in SCALE_FREE else [with_tail_note(target) for target in found]


def _named(ds: xr.Dataset, name: str) -> list[Target]:
    """Return the targets that a user means by a name; none where it means nothing."""
    form, inside, _ = split_name(name)
    found = _targets(ds, _output_in(inside), every=True)
    if form:
        return [target for target in found if target.name == name]
    own = [target for target in found if split_name(target.name)[0] == ""]
    return own or _targets(ds, name)


def _output_in(inside: str) -> str:
    """Return the output or element that the name of a target is about."""
    return inside if "[" in inside else inside.partition("=")[0]


def _targets(ds: xr.Dataset, name: str, every: bool = False) -> list[Target]:
    """Return the targets of an output or of one element of it."""
    if name in ds and ds[name].attrs.get("kind") == "category" and ds[name].ndim == 1:
        return list(category_targets(ds, name))
    known = elements_of(ds, [name]) if name in ds else named_elements(ds, name)
    make = all_targets if every else targets
    return list(make(known, analysis_of(ds).thresholds))


def _plain(index: Index) -> dict[str, float | None]:
    return {name: v if np.isfinite(v) else None for name, v in index._asdict().items()}


def _row(one: _Found, kind: str, labels: list[str]) -> list[tuple[float, float, float]]:
    if isinstance(one.indices, str) or kind not in one.indices.values:
        return [(np.nan, np.nan, np.nan)] * len(labels)
    return [one.indices.values[kind][label] for label in labels]


def _noise(one: _Found) -> Index:
    known = None if isinstance(one.indices, str) else one.indices.noise
    return known or Index(np.nan)


def _dummy(one: _Found, kind: str) -> float:
    return np.nan if isinstance(one.indices, str) else one.indices.dummy.get(kind, np.nan)
