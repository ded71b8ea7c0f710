"""Which inputs an output's scatter comes from: every method, for a result as a whole."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.designs import DESIGNS
from uq.elements import analysis_of, elements_of, named_elements, shown_outputs
from uq.errors import InputError, nearest
from uq.fast import curves, fast_indices
from uq.given_data import given_data_indices
from uq.independent_inputs import are_dependent, independent_inputs, notes_on_inputs
from uq.morris import morris_indices, trajectories
from uq.sobol import crossed, sobol_indices
from uq.targets import Index, Indices, RefusedError, Target, targets

_GROUPED: dict[str, tuple[Callable[..., Any], Callable[..., Indices]]] = {
    "sobol": (crossed, sobol_indices),
    "morris": (trajectories, morris_indices),
    "fast": (curves, fast_indices),
}
"""Methods whose rows belong together: what finds them in a result, and the estimate from them."""


def methods(ds: xr.Dataset) -> tuple[str, ...]:
    """Return the methods that the study asks for, or else the first that its design can feed."""
    feeds = DESIGNS[ds.attrs["design"]].feeds_with(are_dependent(ds))
    return analysis_of(ds).sensitivity or feeds[:1]


def sensitivities(
    ds: xr.Dataset, method: str | None = None, output: str | None = None
) -> dict[str, Any]:
    """Estimate sensitivity indices as plain data, ready for JSON.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    method : str, optional
        By default the first of `methods`.
    output : str, optional
        An output, one element of it, or one of the names that this function returns; by default
        the outputs that the study wants to see.

    Returns
    -------
    dict
        ``method``; ``rows_used`` and ``groups_dropped``, where a group (a row, in designs without
        groups) counts as dropped if any output with indices lacks it; ``outputs``: name -> ``S1``
        and the like -> parameter -> ``value``, ``low``, ``high``. Each output has its own counts
        and ``notes``, and ``dummy`` where the method has no intervals; one without indices has
        ``refused``, a sentence.

    Raises
    ------
    InputError
        When the design cannot feed the method, or there is no such output.
    """
    name, found = _estimate(ds, method, output)
    outputs = {}
    for one in found:
        entry: dict[str, Any] = {"rows_used": one.rows_used, "groups_dropped": one.dropped}
        if isinstance(one.indices, str):
            outputs[one.target.name] = entry | {"refused": one.indices}
            continue
        for kind, values in one.indices.values.items():
            entry[kind] = {label: _plain(index) for label, index in values.items()}
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
        (why there are no indices, or "") over ``output``.

    Raises
    ------
    InputError
        When the design cannot feed the method.
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
    for kind, labels in estimated[0].values.items() if estimated else ():
        dim = "pair" if kind == "S2" else "parameter"
        coords[dim] = list(labels)
        table = np.array([_row(one, kind, list(labels)) for one in found])
        for i, end in enumerate(("", "_low", "_high")):
            data[f"{kind}{end}"] = (("output", dim), table[:, :, i])
    for kind in estimated[0].dummy if estimated else ():
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


def _estimate(ds: xr.Dataset, method: str | None, output: str | None) -> tuple[str, list[_Found]]:
    method = method or methods(ds)[0]
    _check_method(ds, method)
    find, estimate = _GROUPED.get(method, (None, None))
    design = find(ds) if find else None
    inputs, notes = independent_inputs(ds), tuple(notes_on_inputs(ds))
    found = []
    for target in _chosen(ds, output):
        indices: Indices | str
        try:
            if target.refused:
                raise RefusedError(target.refused)
            if estimate is None:
                indices = given_data_indices(method, inputs, target.values)
            else:
                indices = estimate(design, target.values)
            indices = indices._replace(notes=indices.notes + notes)
        except RefusedError as refusal:
            indices = str(refusal)
        whole = np.isfinite(target.values) if design is None else design.whole(target.values)
        found.append(_Found(target, indices, whole, ds.sizes["sample"] // whole.size))
    return method, found


def _check_method(ds: xr.Dataset, method: str) -> None:
    design = ds.attrs["design"]
    feeds = DESIGNS[design].feeds_with(are_dependent(ds))
    if method in feeds:
        return
    if method in DESIGNS[design].feeds:
        raise InputError(
            f"method '{method}' supposes independent inputs, and those of this study are not;"
            f" use {' or '.join(feeds)}"
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


def _chosen(ds: xr.Dataset, output: str | None) -> list[Target]:
    """Return the targets that a user means, all of them or by name."""
    analysis = analysis_of(ds)
    if output is None:
        found = list(targets(elements_of(ds, shown_outputs(ds, analysis)), analysis.thresholds))
        if not found:
            raise InputError("none of the outputs is a number: there is nothing to apportion")
        return found
    # rate(first_time_to_depth[depth=0.00025]) and P(life<1000.0) hold the name of an element.
    element = output.removeprefix("rate(").removeprefix("P(").rstrip(")").partition("<")[0]
    found = list(targets(named_elements(ds, element), analysis.thresholds))
    if output == element:
        return found
    chosen = [target for target in found if target.name == output]
    if not chosen:
        raise InputError(f"no such output '{output}'{nearest(output, [t.name for t in found])}")
    return chosen


def _plain(index: Index) -> dict[str, float | None]:
    return {name: v if np.isfinite(v) else None for name, v in index._asdict().items()}


def _row(one: _Found, kind: str, labels: list[str]) -> list[tuple[float, float, float]]:
    if isinstance(one.indices, str):
        return [(np.nan, np.nan, np.nan)] * len(labels)
    return [one.indices.values[kind][label] for label in labels]


def _dummy(one: _Found, kind: str) -> float:
    return np.nan if isinstance(one.indices, str) else one.indices.dummy[kind]
