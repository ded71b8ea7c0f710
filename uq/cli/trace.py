"""Terminal output of ``uq trace``."""

from pathlib import Path

from uq.cli.printing import grid, heading, note, paragraph, print_json
from uq.render.trace.trace import Trace, trace_json, traced
from uq.result.result import Result

_MOST = 40  # characters of a hash


def trace(result: Path, key: str, model: str | None, json: bool) -> int:
    """Show where a number comes from; return the exit code."""
    provenance = traced(Result.open(result), key, model)
    print_json(trace_json(provenance)) if json else _show(provenance)
    return 0 if provenance.equal else 1


def _show(provenance: Trace) -> None:
    heading(provenance.key)
    grid([(name, _number(value)) for name, value in provenance.numbers.items()])
    heading("\nestimator")
    for citation in provenance.estimators:
        paragraph(citation.does, indent=2)
        paragraph(citation.code, indent=4)
        for source in citation.sources or ("no source: a definition",):
            paragraph(source, indent=4)
    heading("\nrows", f"{provenance.rows_used} of {provenance.rows}")
    paragraph(provenance.which, indent=2)
    grid([(str(count), state) for state, count in provenance.states.items()])
    for text in provenance.notes:
        paragraph(text, indent=2)
    heading("\nmade by")
    here = {f"{name} here": version for name, version in provenance.versions_here.items()}
    made = {**provenance.recorded, **provenance.versions, **here}
    grid([(name, str(value)[:_MOST]) for name, value in made.items()])  # hashes are longer
    equal = "equal to the bit" if provenance.equal else f"NOT EQUAL: {provenance.again}"
    note(f"Computed again from these rows: {equal}.")


def _number(value: object) -> str:
    return "null" if value is None else str(value)
