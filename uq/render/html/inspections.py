"""The inspections from which a result was learnt, as a file to write them into."""

import csv
import io
import json

from uq.result.result import Result


def inspections_csv(result: Result) -> str:
    """Return the inspections inside a result as `uq update` reads them; "" where there are none."""
    inspections = json.loads(result.dataset.attrs.get("inspections", "[]"))
    if not inspections:
        return ""
    text = io.StringIO()
    columns = dict.fromkeys(name for inspection in inspections for name in inspection)
    lines = csv.DictWriter(text, list(columns), lineterminator="\n")
    lines.writeheader()
    lines.writerows(inspections)
    return text.getvalue()
