"""Terminal output of ``uq sensitivity``: tables of 80 columns."""

from collections.abc import Iterator

from uq.assess.answer.number_targets import NumberTarget
from uq.assess.ranked_indices import Values, lines
from uq.assess.sensitivities import Sensitivities
from uq.cli.printing import grid, heading, paragraph
from uq.indices.index import BY_CORRELATION, S1, IndexKind, Indices
from uq.result.result import Result
from uq.text.numbers import counted, in_brackets
from uq.text.units import typical, unit_of


def show(result: Result, sensitivities: Sensitivities) -> None:
    """Print the indices of each target, or why there are none."""
    dropped = sensitivities.groups_dropped
    lost = f", {counted(dropped, 'group')} dropped" if dropped else ""
    more = f"of {counted(sensitivities.rows_used, 'row')}{lost}"
    heading(f"Sensitivity by {sensitivities.method}", more)
    for name, target_indices in sensitivities.targets.items():
        target = NumberTarget(result, name)
        kinds = target_indices.kinds().items()
        effects = [estimates for kind, estimates in kinds if _is_effect(kind)]
        values = [index.value for estimates in effects for index in estimates.values()]
        unit = unit_of(target.units if values else "1", typical(values))
        heading(f"\n{target.name}{in_brackets(unit)}", target.meaning)
        if target_indices.refused:
            paragraph(target_indices.refused, indent=2)
            continue
        for table in (target_indices.kinds(), target_indices.kinds(of_pairs=True)):
            if table:
                header = (text for kind in table for text in (kind.key, "95 % interval"))
                remark = ("",) * bool(target_indices.indices.by_correlation)
                grid(
                    _lines(table, target_indices.indices, unit.size), header=("", *header, *remark)
                )
        if noise := target_indices.indices.noise:
            share = (S1.text(noise.value), S1.interval(noise))
            grid([("noise", *share)], header=("", "share of variance", "95 % interval"))
        for text in target_indices.indices.notes:
            paragraph(text, indent=2)


def _is_effect(kind: IndexKind) -> bool:
    """Return whether an index is in the unit of the output."""
    return kind.unit == "output"


def _lines(table: Values, indices: Indices, per: float) -> Iterator[list[str]]:
    borrowed = indices.by_correlation
    for label, estimates in lines(table, indices.nulls):
        pairs = [
            (kind, estimate.over(per) if _is_effect(kind) else estimate)
            for kind, estimate in zip(table, estimates, strict=True)
        ]
        cells = ((kind.text(estimate.value), kind.interval(estimate)) for kind, estimate in pairs)
        remark = [BY_CORRELATION * (label in borrowed)] if borrowed else []
        yield [label, *(text for pair in cells for text in pair), *remark]
