"""The assessed system: context, quantities, software, models, inputs."""

from collections.abc import Iterator
from shlex import quote

from uq.assess.findings import Findings
from uq.render.html.cells import Cell, HtmlTable
from uq.render.html.dossier.outline import Item
from uq.render.html.inputs import fixed_inputs, input_tables
from uq.render.html.page import references
from uq.render.html.pictures import pictures
from uq.study.file import Tied
from uq.study.provenance import provenance
from uq.text.numbers import quantity


def context(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the purpose of the assessment."""
    study = findings.result.study.study
    yield Item("Purpose", text=[study.description] if study.description else [])
    yield Item("Decision that it supports, and the rules that apply to it")


def information(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the information required to repeat the assessment."""
    result = findings.result
    name, model = result.study.study.name, result.model_option
    yield Item(
        "Result",
        facts=[
            ("file", file),
            ("rows", str(len(result))),
            ("SHA-256 of the study", str(result.dataset.attrs["study_sha256"])),
        ],
    )
    yield Item(
        "Commands that repeat it",
        text=[
            "The study file is in the appendix. On the same processor and versions the numbers"
            " are equal to the bit, on others up to rounding."
        ],
        code=f"uq run {name}.toml --samples {result.dataset.attrs['samples']}{model}\n"
        f"uq verify {quote(file)}{model}",
    )
    yield Item(
        "Key of each number",
        text=[
            "Tables show the key of a number when the pointer rests on it;"
            f" 'uq trace {quote(file)} KEY' prints its estimator, its rows and its origin, and"
            " computes it again."
        ],
    )
    yield Item("Reports of tests and measurements on which inputs or models rest")


def quantities(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the quantities of interest."""
    result = findings.result
    asked, declared = result.analysis, result.outputs
    lines = [
        (
            Cell(name),
            Cell(output.meaning),
            Cell(output.unit),
            Cell(output.kind),
            Cell(", ".join(output.dims)),
        )
        for name in result.shown_outputs(asked)
        for output in [declared[name]]
    ]
    header = ("output", "meaning", "unit", "kind", "one for each")
    yield Item("Quantities of interest", tables=[HtmlTable("Outputs", header, lines)])
    limits = [
        (Cell(name), Cell(quantity(at, declared[name].unit), key=at))
        for name, several in asked.thresholds.items()
        for at in several
    ]
    stated = [HtmlTable("Thresholds", ("output", "threshold"), limits)] if limits else []
    yield Item("Thresholds", tables=stated)
    yield Item(
        "Acceptance criteria", notes=["A study does not state which probability is allowed."]
    )


def software(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the versions and verification of the software."""
    attrs = findings.result.dataset.attrs
    here = [(name, str(attrs[name])) for name in provenance() if name in attrs]
    yield Item("Versions and processor", facts=here)
    yield Item("Quality assurance programme")
    note = "The tests of vibrolife are part of its source, not of a result."
    yield Item("Verification against known solutions", notes=[note])
    command = f"uq verify {quote(file)}{findings.result.model_option}"
    note = f"'{command}' computes rows again and compares them to the bit."
    yield Item("Rows computed again", notes=[note])
    yield Item("Validation against observations")


def models(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the version, sources and settings of the model."""
    attrs = findings.result.dataset.attrs
    named = ("model", "model_version", "code")
    facts = [(name.replace("_", " "), str(attrs[name])) for name in named if name in attrs]
    yield Item("Model", facts=facts)
    yield Item("Sources", text=references(findings.result) or ())
    settings = findings.result.study.settings
    given = [(name, str(value)) for name, value in settings.items()]
    yield Item("Numerical settings", facts=given, text=[] if given else ["The model's defaults."])
    yield Item("Uncertainty of the form of the model")


def inputs(findings: Findings, file: str) -> Iterator[Item]:
    """Yield the laws of the inputs."""
    result = findings.result
    study = result.study
    laws, *correlations = input_tables(result)
    yield Item("Laws and their sources", tables=[laws])
    independent = [] if correlations else ["The laws are independent."]
    if result.has_weights and not result.has_next_rows:
        independent.append("Given the inspections, the inputs need not be independent.")
    yield Item("Dependence", text=independent, tables=correlations)
    levels = [
        (Cell(name), Cell(origin.level or ""))
        for name, entry in study.uncertain.items()
        for origin in [study.uncertain[entry.equals] if isinstance(entry, Tied) else entry]
    ]
    shared = (
        [HtmlTable("Level of each input", ("input", "level"), levels)] if result.is_nested else []
    )
    yield Item("Variability between units, and what all units share", tables=shared)
    learnt = str(result.dataset.attrs.get("inspections", ""))
    yield Item("Inspections from which the laws were learnt", code=learnt)
    fixed = fixed_inputs(result)
    yield Item("Fixed inputs", tables=[] if fixed is None else [fixed])
    yield Item("Inputs as drawn", pictures=list(pictures(findings, "inputs")))
