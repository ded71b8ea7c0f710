"""Chapters of a dossier: what a result provides under each heading, and the dossier as HTML."""

from collections.abc import Iterator
from math import isfinite

from markupsafe import Markup

from uq.assess.answer.answer import conclude, verdict
from uq.assess.answer.quantities import Quantity
from uq.assess.answer.tolerance_bound import Range
from uq.assess.answer.wording import scale_warning
from uq.assess.findings import Findings
from uq.assess.statistic import Reader
from uq.assess.summary import REGIME
from uq.indices.methods import METHODS
from uq.render.html.answer import fragment, warning
from uq.render.html.cells import Cell, HtmlTable
from uq.render.html.convergence import convergence_of, fleet_notes, fleet_table, levels_of
from uq.render.html.dossier.assessment import (
    context,
    information,
    inputs,
    models,
    quantities,
    software,
)
from uq.render.html.dossier.outline import DOCUMENTS, Heading, Item
from uq.render.html.indices import of_output, sensitivity_of
from uq.render.html.outcomes import (
    assumed_scales,
    category_table,
    outcomes,
    regime_tables,
    result_tables,
    status_table,
)
from uq.render.html.page import laid_out
from uq.render.html.pictures import about, pictures
from uq.render.trace.trace import cited
from uq.result.nesting import size_in_words
from uq.result.result import Result
from uq.sampling.designs import DESIGNS
from uq.text.keys import key_of

COVERAGE = 0.9
"""Coverage of the interval between the quantiles in the answer, 5 and 95 %."""


def propagation(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the method of uncertainty propagation, and the status of the rows."""
    result, summary = findings.result, findings.summary
    attrs = result.dataset.attrs
    rows = [("rows", str(summary.samples)), ("independent rows", str(summary.rows_used))]
    if result.is_nested:
        place = result.nesting
        rows.append(("samples", size_in_words(place.samples, place.units, place.repeats)))
    yield Item(
        "Design",
        facts=[
            ("method", f"{attrs['design']}: {DESIGNS[attrs['design']].meaning}"),
            ("replicates", str(attrs["replicates"])),
            ("seed", str(attrs["seed"])),
            *rows,
        ],
    )
    lost, most = int(result.failed.sum()), 100 * result.analysis.max_failed
    yield Item(
        "Rows that could not be computed",
        text=[
            f"{lost} of {summary.samples} rows are invalid; the study allows {most:g} %. They are"
            " left out of every statistic, and tolerance bounds count them as the worst value."
        ],
        tables=[status_table(result, summary)],
    )


def convergence(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the evidence that the sample size is sufficient."""
    estimates = convergence_of(findings, outcomes(findings.result, findings.summary))
    yield Item("Verdict", text=verdict(findings))
    refused = list(filter(None, [estimates["refused"]]))
    yield Item(
        "Sampling error, and numerical error of the rows",
        tables=list(filter(None, [estimates["table"]])),
        notes=estimates["warnings"] + refused,
    )
    yield Item(
        "Estimates against the number of rows", pictures=estimates["pictures"], notes=refused
    )


def sensitivities(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the sensitivity indices of each output by each method."""
    methods = sensitivity_of(findings)
    yield Item(
        "Methods",
        facts=[
            (method, f"{METHODS[method].question}; {used}") for method, (used, _) in methods.items()
        ],
        notes=[] if methods else ["The design of this study supports no sensitivity method."],
    )
    for name in dict.fromkeys(
        table.output for _, subjects in methods.values() for table in subjects
    ):
        yield Item(f"Indices of {name}", subjects=of_output(methods, name))


def uncertainty(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the estimated uncertainty of the quantities of interest."""
    described = outcomes(findings.result, findings.summary)
    of_jcgm = _coverage_intervals(findings)
    answer = conclude(findings)
    scaled = dict.fromkeys(quantity.scaled_by for quantity in answer.quantities)
    yield Item(
        "Estimate, standard uncertainty and coverage interval",
        html=Markup("").join(warning(scale_warning(names)) for names in scaled),
        tables=[of_jcgm] if of_jcgm.rows else [],
        notes=[
            "As JCGM 101, 5.5 requires: the intervals are probabilistically symmetric, from the 5"
            " % to the 95 % quantile, and cover variability and lack of knowledge together."
        ],
    )
    drawn = list(pictures(findings, "results", without=findings.absent))
    for name in dict.fromkeys(outcome.output for outcome in described):
        yield Item(
            f"Statistics of {name}",
            html=warning(scale_warning(assumed_scales(answer, name))),
            tables=list(
                result_tables([outcome for outcome in described if outcome.output == name])
            ),
            pictures=about(drawn, name),
        )
    for name, shares in findings.summary.categories.items():
        yield Item(f"Statistics of {name}", tables=[category_table(name, shares)])
    if findings.summary.notes:
        yield Item("Limits of the rows", text=findings.summary.notes)
    if findings.summary.regimes:
        of_regimes = [figure for figure in drawn if figure.output == REGIME]
        yield Item(
            "Regimes",
            tables=regime_tables(findings),
            pictures=[*of_regimes, *pictures(findings, "rows")],
        )
    yield Item("Estimators and their sources", tables=_estimators(findings))
    levels, fleets = levels_of(findings), fleet_table(findings)
    yield Item(
        "Variance components by level",
        tables=[table for table in (levels and levels["table"], fleets) if table],
        notes=levels["notes"] + fleet_notes(findings) if levels else ["Each sample has one row."],
    )


def _coverage_intervals(findings: Findings) -> HtmlTable:
    header = (
        "output",
        "unit",
        "estimate (mean)",
        "standard uncertainty",
        "coverage",
        "from",
        "to",
    )
    quantities = conclude(findings).quantities
    rows = [
        _interval(findings, quantity, quantity.range)
        for quantity in quantities
        if quantity.range is not None
    ]
    return HtmlTable("Estimates and coverage intervals", header, rows)


def _interval(findings: Findings, quantity: Quantity, likely: Range) -> tuple[Cell, ...]:
    unit, described = likely.unit, findings.summary.outputs[quantity.name]

    def cell(value: float, *key: str) -> Cell:
        if value != value:
            return Cell("-")
        traced = key_of("outputs", quantity.name, *key) if described.find(*key) else ""
        text = unit.number(value) if isfinite(value) else unit.text(value)
        return Cell(text, key=value if isfinite(value) else None, traced=traced)

    moments = (described.find(key) for key in ("mean", "sd"))
    return (
        Cell(quantity.name, quantity.words),
        Cell(unit.name),
        *(cell(statistic.estimate.value, *statistic.key) for statistic in moments if statistic),
        Cell(f"{100 * COVERAGE:g} %"),
        cell(likely.low.value, "quantiles", "0.05"),
        cell(likely.high.value, "quantiles", "0.95"),
    )


def _estimators(findings: Findings) -> list[HtmlTable]:
    """Return the estimators of the tabulated statistics, with their references."""
    functions = dict.fromkeys(
        function
        for described in findings.summary.outputs.values()
        for statistic in described.statistics
        if statistic.is_read_by(Reader.REPORT)
        for function in statistic.by
    )
    rows = [
        (
            Cell(citation.does),
            Cell("; ".join(citation.sources) or "a definition"),
            Cell(citation.code),
        )
        for citation in map(cited, functions)
    ]
    header = ("estimator", "source", "function")
    return [HtmlTable("Estimators", header, rows)] if rows else []


def studies(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the effects of alternative assumptions."""
    advised = [advice.text for advice in conclude(findings).advice if advice.tightened is not None]
    yield Item("Less scatter of the leading input", text=advised)
    note = (
        "'uq what-if' shows the same rows under other laws, 'uq compare' two studies; neither is"
        " part of a result."
    )
    yield Item("Other laws, models and numerical settings", notes=[note])


def conclusions(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the answer."""
    yield Item("The answer", html=fragment(conclude(findings)))
    yield Item("Comparison with the acceptance criteria")


_TOPICS = "RG 1.245, section C.2"

OUTLINE = (
    Heading(context, "Context", (_TOPICS,)),
    Heading(information, "Information made available", (_TOPICS,)),
    Heading(
        quantities,
        "Quantities of interest and acceptance criteria",
        (_TOPICS, "JCGM 101, 5.1"),
    ),
    Heading(
        software,
        "Software quality assurance, verification and validation",
        (_TOPICS,),
    ),
    Heading(models, "Models", (_TOPICS, "JCGM 101, 5.1")),
    Heading(inputs, "Inputs and their uncertainty", (_TOPICS, "JCGM 101, 6")),
    Heading(propagation, "Propagation of uncertainty", (_TOPICS, "JCGM 101, 7.2 to 7.4")),
    Heading(convergence, "Convergence", (_TOPICS, "JCGM 101, 7.9")),
    Heading(sensitivities, "Sensitivity analyses", (_TOPICS,)),
    Heading(
        uncertainty,
        "Uncertainty of the quantities of interest",
        (_TOPICS, "JCGM 101, 5.5"),
    ),
    Heading(studies, "Sensitivity studies", (_TOPICS,)),
    Heading(conclusions, "Conclusions", ("NUREG/CR-7278",)),
)
"""Headings in the order of RG 1.245, with our own wording."""


def chapters(result: Result, file: str) -> dict[Heading, list[Item]]:
    """Return the items expected under each heading, provided or not, in the order of the outline.

    Parameters
    ----------
    result : Result
        A result.
    file : str
        Name of the result file.
    """
    findings = Findings(result)
    return {heading: list(heading.source(findings, file)) for heading in OUTLINE}


def dossier(result: Result, name: str) -> str:
    """Return the dossier of a result as HTML; as `uq.render.html.page.page` returns its report."""
    return laid_out(
        "dossier/dossier.html", result, chapters=chapters(result, name), documents=DOCUMENTS
    )
