"""All that a report says of one output."""

from collections.abc import Iterator, Sequence
from typing import Any

from uq.assess.answer.facts import Answer
from uq.assess.findings import Findings
from uq.assess.summary import REGIME
from uq.render.html.answer import sayings
from uq.render.html.indices import Methods, of_output
from uq.render.html.outcomes import Outcome, category_table, result_tables, words_used
from uq.render.html.pictures import Picture, about
from uq.text.symbols import readable


def groups(
    findings: Findings,
    answer: Answer,
    outcomes: Sequence[Outcome],
    drawn: Sequence[Picture],
    methods: Methods,
) -> Iterator[dict[str, Any]]:
    """Yield what is known of each output that the study asks for, the one it is about first.

    Parameters
    ----------
    findings : Findings
    answer : Answer
    outcomes : sequence of Outcome
        The elements of all outputs.
    drawn : sequence of Picture
        Those that the head of the report does not show.
    methods : Methods

    Yields
    ------
    dict
        Name and meaning of an output; ``sentences`` of the answer, without what the head of the
        report says; ``tables``; ``words`` that explain the counts; ``pictures``; ``indices``.
    """
    result = findings.result
    shown = result.shown_outputs(result.analysis)
    for name in dict.fromkeys((*(quantity.output for quantity in answer.quantities), *shown)):
        if name == REGIME:  # it has its own section
            continue
        matching = [outcome for outcome in outcomes if outcome.output == name]
        shares = (
            category_table(element, of_labels)
            for element, of_labels in findings.summary.categories.items()
            if element.partition("[")[0] == name and of_labels
        )
        others = [quantity for quantity in answer.quantities[1:] if quantity.output == name]
        contents = {
            "sentences": sayings(answer, others),
            "tables": [*shares, *result_tables(matching)],
            "words": words_used(matching),
            "pictures": about(drawn, name),
            "indices": of_output(methods, name),
        }
        if any(contents.values()):
            meaning = readable(str(result.dataset[name].attrs["long_name"]))
            yield {"name": name, "meaning": meaning} | contents
