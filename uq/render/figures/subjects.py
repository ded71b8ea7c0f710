"""The subjects of figures, and the conditions under which a figure applies to them."""

from collections.abc import Iterator, Sequence

from uq.assess.answer.answer import conclude
from uq.assess.answer.compared_indices import method_for
from uq.assess.answer.events import events_of
from uq.assess.answer.quantities import by_importance
from uq.assess.findings import Findings
from uq.assess.life_fit import fits_of
from uq.assess.row_inputs import independent_inputs
from uq.assess.sampled_laws import laws_and_values
from uq.assess.sensitivities import TargetIndices, methods
from uq.assess.statistic import Context
from uq.assess.statistics.causes import refusal
from uq.assess.summary import REGIME
from uq.assess.targets import number_of, split_name, transformed_if_heavy
from uq.errors import InputError
from uq.indices.methods import METHODS
from uq.render.figures.catalogue import FigureSubject
from uq.render.figures.convergence_plot import followed, total_indices
from uq.render.figures.elements_plot import occurring_regimes
from uq.render.figures.index_plot import dimension_of
from uq.text.element_names import is_whole

_MOST_INPUTS = 6
_MOST_OUTPUTS = 2
_FEWEST_ROWS = 80


def the_result(findings: Findings) -> Iterator[FigureSubject]:
    """Yield the result itself."""
    yield FigureSubject()


def outputs(findings: Findings) -> Iterator[FigureSubject]:
    """Yield each output with numbers."""
    if len(findings.rows):
        declared, result = findings.result.outputs, findings.result
        shown = result.shown_outputs(result.analysis)
        yield from (FigureSubject(output) for output in shown if not declared[output].is_category)


def leading_outputs(findings: Findings) -> tuple[str, ...]:
    """Return the outputs that the study is about, its subject first."""
    declared = findings.result.outputs
    ordered = by_importance(findings.result, findings.result.analysis)
    absent = findings.absent if len(findings.rows) else ()
    numbers = (name for name in ordered if not declared[name].is_category and name not in absent)
    return tuple(numbers)[:_MOST_OUTPUTS]


def the_first(findings: Findings, names: Sequence[str]) -> Iterator[FigureSubject]:
    """Yield the first of the leading outputs."""
    if len(findings.rows):
        yield from map(FigureSubject, names[:1])


def the_result_alone(findings: Findings, names: Sequence[str]) -> Iterator[FigureSubject]:
    """Yield the result itself, unless outputs are asked for by name."""
    if tuple(names) == leading_outputs(findings):
        yield FigureSubject()


def leading_categories(findings: Findings, names: Sequence[str]) -> Iterator[FigureSubject]:
    """Yield each category that the study names, and the regime."""
    shown = {*findings.result.analysis.outputs, REGIME}
    for category in categories(findings):
        if category.output == REGIME and in_one_regime(findings, REGIME):
            continue
        if category.output in (shown if tuple(names) == leading_outputs(findings) else names):
            yield category


def indices_of_the_first(findings: Findings, names: Sequence[str]) -> Iterator[FigureSubject]:
    """Yield the target that ranks the inputs of the first of the leading outputs."""
    for output in names[:1]:
        able = [method_for(findings.result, event=False), *methods(findings.result)]
        method = next(filter(None, able), None)
        if method is None:
            continue
        target = number_of(findings.result.named_elements(output)[0])
        name = (target if METHODS[method].scale_free else transformed_if_heavy(target)).name
        try:
            target_indices = findings.indices(method, name)
        except InputError:
            continue
        if not target_indices.refused and target_indices.kinds():
            yield FigureSubject(name, method, {"method": method, "indices": target_indices})


def events_of_the_first(findings: Findings, names: Sequence[str]) -> Iterator[FigureSubject]:
    """Yield the events of the first of the leading outputs with an identified main driver."""
    for output in names[:1]:
        for event in events_of(findings, findings.rows.named_elements(output)[0]):
            if event.curve is not None:
                yield FigureSubject(event.name, keywords={"event": event})


def inputs(findings: Findings) -> Iterator[FigureSubject]:
    """Yield the inputs with laws, in groups that fit a quarter of a page."""
    names = list(laws_and_values(findings.result))
    count = -(-len(names) // _MOST_INPUTS)
    for i in range(count):
        part = f"{i + 1} of {count}" if count > 1 else ""
        group = names[i * len(names) // count : (i + 1) * len(names) // count]
        yield FigureSubject(part=part, keywords={"names": group})


def categories(findings: Findings) -> Iterator[FigureSubject]:
    """Yield each category that occurs, the regime among them."""
    if len(findings.rows):
        shares = findings.summary.shares.items()
        occur = (
            name
            for name, statistics in shares
            if any(statistic.facts["count"] for statistic in statistics.values())
        )
        yield from map(FigureSubject, dict.fromkeys(name.partition("[")[0] for name in occur))


def targets(findings: Findings) -> Iterator[FigureSubject]:
    """Yield each target of each sensitivity method."""
    for method, target_indices in _indices(findings):
        yield FigureSubject(
            target_indices.name, method, {"method": method, "indices": target_indices}
        )


def _indices(findings: Findings) -> Iterator[tuple[str, TargetIndices]]:
    """Yield each sensitivity method with the indices of each target."""
    for method in methods(findings.result):
        try:
            targets_of = findings.sensitivities(method).targets
        except InputError:  # the report gives the reason
            continue
        for target_indices in targets_of.values():
            if not target_indices.refused and target_indices.kinds():
                yield method, target_indices


def curves(findings: Findings) -> Iterator[FigureSubject]:
    """Yield each output with a dimension of three or more numbers, by each method."""
    for method, target_indices in _indices(findings):
        inside = split_name(target_indices.name)[1]
        output = inside.partition("[")[0]
        if is_whole(inside) and dimension_of(findings.result, output):
            yield FigureSubject(output, method, {"method": method, "findings": findings})


def decided_events(findings: Findings) -> Iterator[FigureSubject]:
    """Yield each event with an identified main driver."""
    for event in conclude(findings).events:
        if event.curve is not None:
            yield FigureSubject(event.name, keywords={"event": event})


def crossed_targets(findings: Findings) -> Iterator[FigureSubject]:
    """Yield each target with running estimates of its total indices."""
    if any(outputs(findings)):
        names = findings.running["output"]
        with_totals = total_indices(findings.running)["output"]
        yield from map(FigureSubject, names[names.isin(with_totals)].unique())


def is_lifetime(findings: Findings, name: str) -> bool:
    """Return whether the output is a lifetime."""
    return findings.result.outputs[name].is_lifetime


def is_no_lifetime(findings: Findings, name: str) -> bool:
    """Return whether the output is not a lifetime."""
    return not is_lifetime(findings, name)


def has_causes(findings: Findings, name: str) -> bool:
    """Return whether the lives of the output have causes with an estimate of their incidence."""
    element = findings.rows.named_elements(name)[0]
    context = Context(findings.rows, findings.result.analysis)
    return element.causes is not None and not refusal(element, context)


def has_weibull_law(findings: Findings, name: str) -> bool:
    """Return whether the output is a lifetime to which a Weibull law can be fitted."""
    if not is_lifetime(findings, name) or findings.result.has_weights:
        return False
    element = findings.rows.named_elements(name)[0]
    return not fits_of(element, True, True, ("weibull",))["weibull"].refused


def in_regimes(findings: Findings, name: str) -> bool:
    """Return whether the rows are in several regimes."""
    return len(occurring_regimes(findings.rows)) > 1


def in_one_regime(findings: Findings, name: str) -> bool:
    """Return whether all rows are in one regime, or the model has no regimes."""
    return not in_regimes(findings, name)


def has_plain_rows(findings: Findings, name: str) -> bool:
    """Return whether all rows have equal weight."""
    return not findings.result.has_weights


def has_inputs(findings: Findings, name: str) -> bool:
    """Return whether an input varies."""
    return bool(findings.result.study.uncertain)


def has_enough_rows(findings: Findings, name: str) -> bool:
    """Return whether an input varies, and there are enough rows for slices of it."""
    return bool(independent_inputs(findings.rows)) and len(findings.rows) >= _FEWEST_ROWS


def has_several_inputs(findings: Findings, name: str) -> bool:
    """Return whether at least two inputs vary independently."""
    return len(independent_inputs(findings.rows)) > 1


def has_running_estimate(findings: Findings, name: str) -> bool:
    """Return whether the output has running estimates."""
    return bool(followed(findings.result, name, findings.running)[0])
