"""Terminal output of ``uq check``."""

from itertools import combinations

from uq.cli.printing import grid, heading, number, paragraph
from uq.cli.progress import say
from uq.execution import runner
from uq.execution.loading import load_study
from uq.indices.methods import fed_by
from uq.sampling.designs import DESIGNS
from uq.sampling.levels import OWN
from uq.study.definition import Study
from uq.study.file import DesignTable
from uq.study.hints import hints
from uq.study.row_sampling import group_size, rows
from uq.text.numbers import counted, in_brackets, law, listed, threshold
from uq.text.units import powers, typical, unit_of


def check(path: str, model: str | None) -> None:
    """Print what a study would run, if it is valid."""
    study = load_study(path, model, say)
    design = study.design
    heading(f"{path}: valid", study.description)
    kind = DESIGNS[design.method]
    factors = {
        "replicates": design.replicates,
        "rows each": group_size(study),
        "units": design.units,
        "repeats": design.repeats,
    }
    parts = [counted(design.samples, "sample")]
    parts += [f"{count} {name}" for name, count in factors.items() if count > 1]
    stated = ", stated to be independent" * design.independent
    if design.rows_of_a_sample > 1 and kind.independent:
        stated += "; those of one sample are not"
    dependent = study.dependence is not None or (kind.imported and not design.independent)
    shared = study.random and kind.shares_seeds
    seeds = "the model is random: rows that are compared share a seed"
    seeds += "; one more row of each gives the share of noise" * kind.crossed
    grid(
        [
            ("model", f"{study.model.name}, version {study.model.version}"),
            ("design", f"{design.method}: {kind.meaning}{stated}"),
            ("rows", f"{rows(study)} = {' x '.join(parts)}" if parts[1:] else str(rows(study))),
            *([("until", _until(design))] if design.until else ()),
            *([("seeds", seeds)] * shared),
            ("outputs", ", ".join(study.analysis.outputs)),
            ("sensitivity", f"this design can provide {', '.join(fed_by(kind, dependent))}"),
            ("result", str(runner.output_path(study))),
        ]
    )
    heading("\nUncertain inputs")
    laws = [(name, law(stated), _unit(study, name)) for name, stated in study.uncertain.items()]
    ties = [(name, f"equals {tied.equals}", "") for name, tied in study.tied.items()]
    header = ("parameter", "distribution", "unit")
    by_level = design.rows_of_a_sample > 1 or set(study.levels) != {OWN}
    levels = [(study.level(line[0]),) * by_level for line in laws + ties]
    lines = [line + level for line, level in zip(laws + ties, levels, strict=True)]
    grid(lines, header=header + ("level",) * by_level)
    _show_sampled(study)
    if lacking := hints(study):
        heading("\nBefore you run it")
        for sentence in lacking:
            paragraph(sentence, indent=2)


def _until(design: DesignTable) -> str:
    """Return at which sizes a run may stop, and on what."""
    from uq.assess.stopping import confidence, interim_sizes

    assert design.until is not None
    until, *sizes = design.until, *map(str, interim_sizes(design))
    half_width = threshold(until.half_width, "1")
    return (
        f"{until.estimate} of {until.output} is known to +-{half_width}; checked at"
        f" {listed(sizes)} samples, each time with a confidence of {confidence(design):.2%}"
    )


def _unit(study: Study, name: str) -> str:
    times = study.uncertain[name].times
    return powers(study.model.parameter(name).unit) if times is None else f"x {times}"


def _show_sampled(study: Study) -> None:
    """Print the law of each input as stated and in the rows."""
    from uq.assess.sampled_inputs import MAX_ROWS, sampled_inputs, sampled_ranks

    count = -(-min(rows(study), MAX_ROWS) // study.design.rows_of_a_sample)
    inputs = sampled_inputs(study)
    if not inputs:
        print(f"\nThe rows of a '{study.design.method}' design do not follow these laws.")
        return
    nested = study.design.rows_of_a_sample > 1
    heading(
        f"\nIn {counted(count, 'row')}{', one of each sample' * nested}",
        f"(independent rows would be less than {1.36 / count**0.5:.2g} off in 19 of 20 cases)",
    )
    lines = []
    for name, sampled_input in inputs.items():
        is_factor = name in study.uncertain and study.uncertain[name].times is not None
        units = "1" if is_factor else study.model.parameter(name).unit
        unit = unit_of(units, typical(sampled_input.stated))
        law_ends, row_ends = (
            map(number, quantiles / unit.size)
            for quantiles in (sampled_input.stated, sampled_input.sampled)
        )
        lines.append((name, "stated", *law_ends, ""))
        lines.append((f" {in_brackets(unit)}", "rows", *row_ends, f"{sampled_input.distance:.2g}"))
    grid(lines, header=("parameter", "", "5 %", "50 %", "95 %", "largest distance"))
    if study.dependence is not None:
        heading("\nRank correlations")
        ranks, names = sampled_ranks(study), study.dependence.parameters
        stated = study.dependence.rank_correlation
        grid(
            [
                (f"{names[i]}, {names[j]}", number(stated[i][j]), f"{ranks[i, j]:.3f}")
                for i, j in combinations(range(len(names)), 2)
            ],
            header=("", "stated", "rows"),
        )
