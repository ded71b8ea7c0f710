"""Secondary parts of the answer, as HTML to be unfolded."""

from collections.abc import Collection, Iterable

from markupsafe import Markup

from uq.assess.answer.facts import Answer
from uq.assess.answer.remedies import Advice, TighterTolerance
from uq.assess.answer.wording import called_together
from uq.render.html import keyed_sentences
from uq.text.literals import plain
from uq.text.numbers import capitalized, printed


def folded(title: str, content: Markup) -> Markup:
    """Return content below a title that unfolds it; "" without content."""
    whole = Markup("<details><summary>{}</summary>{}</details>").format(title, content)
    return whole if content else Markup()


def items(lines: Iterable[str]) -> Markup:
    """Return lines as a list; "" without any."""
    found = Markup("").join(Markup("<li>{}</li>").format(_shown(one)) for one in lines if one)
    return Markup("<ul>{}</ul>").format(found) if found else found


def unsettled(answer: Answer) -> Markup:
    """Return what is not settled besides what is advised; "" where there is nothing."""
    return folded("What is not settled besides", items(answer.enough.others))


def below(one: Advice) -> Markup:
    """Return what belongs to a piece of advice: what other tolerances would change."""
    if len(one.tolerances) < 2:
        return Markup()
    return folded("Half the scatter of each input", _tolerances(one))


def _tolerances(advice: Advice) -> Markup:
    """Return a table: what half the scatter of each input would make of each number."""
    known, above = advice.tolerances, {advice.key, *(one.key for one in advice.alike)}
    numbers = {one.statistic: one for one in known}
    lines = [["As studied", *(_number(one.text(one.before)) for one in numbers.values())]]
    for inputs in dict.fromkeys(one.inputs for one in known):
        own = {one.statistic: one for one in known if one.inputs == inputs}
        cells = (
            _cell(own[what], above) if what in own else Markup("<td></td>") for what in numbers
        )
        law = Markup("<small>{}</small>").format(_shown(next(iter(own.values())).law))
        lines.append([_shown(capitalized(called_together(inputs))) + law, *cells])
    head = Markup("").join(
        Markup('<th scope="col" class="number">{}</th>').format(
            _shown(capitalized(what.removeprefix("the ")))
        )
        for what in numbers
    )
    body = Markup("").join(
        Markup('<tr><th scope="row">{}</th>{}</tr>').format(_shown(first), Markup("").join(cells))
        for first, *cells in lines
    )
    table = Markup("<table><thead><tr><td></td>{}</tr></thead><tbody>{}</tbody></table>")
    return Markup('<div class="wide">{}</div>').format(table.format(head, body))


def _number(text: str) -> Markup:
    return Markup('<td class="number">{}</td>').format(_shown(text))


def _cell(one: TighterTolerance, above: Collection[str]) -> Markup:
    """Return a number with its interval, and with its key where no sentence above has it."""
    text = one.text(one.after)
    number = _shown(text) if one.key in above else keyed_sentences.keyed(text, one.key)
    return Markup('<td class="number">{}<small>{}</small></td>').format(
        number, _shown(one.interval)
    )


def _shown(text: str) -> str:
    return text if isinstance(text, Markup) else plain(printed(text))
