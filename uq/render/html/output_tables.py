"""All that a report says of one output."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from markupsafe import Markup

from uq.assess.answer.facts import Answer
from uq.assess.findings import Findings
from uq.assess.summary import REGIME
from uq.render.html.answer import sayings
from uq.render.html.cells import HtmlTable
from uq.render.html.indices import IndexTable, MethodTable, of_output, output_of
from uq.render.html.outcomes import Outcome, category_table, result_tables, words_used
from uq.render.html.pictures import Picture
from uq.text.symbols import readable


class Group(NamedTuple):
    """What is known of an output.

    Attributes
    ----------
    name, meaning : str
    sentences : Markup
        The answer, without what the head of the report says.
    tables : list of HtmlTable
    words : list of str
        What the counts mean that occur.
    pictures : list of Picture
    indices : list of IndexTable
    """

    name: str
    meaning: str
    sentences: Markup
    tables: list[HtmlTable]
    words: list[str]
    pictures: list[Picture]
    indices: list[IndexTable]


def groups(
    findings: Findings,
    answer: Answer,
    outcomes: Sequence[Outcome],
    drawn: Sequence[Picture],
    methods: Sequence[MethodTable],
) -> Iterator[Group]:
    """Yield what is known of each output that the study asks for, the one it is about first.

    Parameters
    ----------
    findings : Findings
    answer : Answer
    found : sequence of Outcome
        The elements of all outputs.
    drawn : sequence of Picture
        Those that the head of the report does not show.
    methods : sequence of MethodTable
    """
    result = findings.result
    shown = result.shown_outputs(result.analysis)
    for name in dict.fromkeys((*(quantity.output for quantity in answer.quantities), *shown)):
        if name == REGIME:  # it has its own section
            continue
        matching = [outcome for outcome in outcomes if outcome.output == name]
        group = Group(
            name,
            readable(str(result.dataset[name].attrs["long_name"])),
            sayings(answer, [entry for entry in answer.quantities[1:] if entry.output == name]),
            [*_shares(findings, name), *result_tables(matching)],
            words_used(matching),
            [figure for figure in drawn if name in (figure.of.name, output_of(figure.of.name))],
            of_output(methods, name),
        )
        if any(group[2:]):
            yield group


def _shares(findings: Findings, name: str) -> Iterator[HtmlTable]:
    """Yield the shares of a category, of each element."""
    for element, shares in findings.summary.categories.items():
        if element.partition("[")[0] == name and shares:
            yield category_table(element, shares)
