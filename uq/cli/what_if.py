"""Terminal output of ``uq what-if``."""

from math import isfinite
from pathlib import Path

from uq.assess.what_if import read_changes, reweighted_summary, what_if_facts
from uq.cli.printing import note, print_json
from uq.cli.summary_tables import show_summary
from uq.result.result import Result


def what_if(result: Path, changes: list[str], json: bool) -> None:
    """Print the summary of a result under other laws."""
    opened = Result.open(result)
    reweighted = reweighted_summary(opened, read_changes(changes))
    if json:
        print_json(what_if_facts(reweighted).json)
        return
    show_summary(opened, reweighted.summary)
    note(
        f"What if: {'; '.join(changes)}. The same rows, weighted: worth"
        f" {reweighted.effective_rows:.0f} independent ones"
        + (f"; Pareto k = {reweighted.pareto_k:.2f}." if isfinite(reweighted.pareto_k) else ".")
    )
