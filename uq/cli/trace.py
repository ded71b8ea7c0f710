"""What ``uq trace`` shows."""

from pathlib import Path

from uq.cli.printing import grid, heading, note, paragraph, print_json
from uq.render.trace.trace import Trace, trace_json, traced
from uq.result.result_file import open_result

_MOST = 40  # characters of a hash


def trace(result: Path, key: str, model: str | None, json: bool) -> int:
    """Show where a number comes from; return the exit code."""
    found = traced(open_result(result), key, model)
    print_json(trace_json(found)) if json else _show(found)
    return 0 if found.equal else 1


def _show(found: Trace) -> None:
    heading(found.key)
    grid([(name, _number(value)) for name, value in found.numbers.items()])
    heading("\nestimator")
    for one in found.estimators:
        paragraph(one.does, indent=2)
        paragraph(one.code, indent=4)
        for source in one.sources or ("no source: a definition",):
            paragraph(source, indent=4)
    heading("\nrows", f"{found.rows_used} of {found.rows}")
    paragraph(found.which, indent=2)
    grid([(str(count), state) for state, count in found.states.items()])
    for text in found.notes:
        paragraph(text, indent=2)
    heading("\nmade by")
    here = {f"{name} here": version for name, version in found.versions_here.items()}
    made = {**found.recorded, **found.versions, **here}
    grid([(name, str(value)[:_MOST]) for name, value in made.items()])  # hashes are longer
    equal = "equal to the bit" if found.equal else f"NOT EQUAL: {found.again}"
    note(f"Computed again from these rows: {equal}.")


def _number(value: object) -> str:
    return "null" if value is None else str(value)
