"""The answer as HTML, for a notebook and for the head of a report."""

from collections.abc import Iterator, Sequence

from markupsafe import Markup

from uq.assess.answer.contributions import Contribution
from uq.assess.answer.facts import Answer
from uq.assess.answer.parts import Quantity
from uq.assess.answer.wording import called, sentence
from uq.errors import choices
from uq.render.html import bars, folded, keyed_sentences
from uq.text.literals import plain
from uq.text.numbers import capitalized, printed

_STYLE = """
.answer, .answer-words, .answer-side { display: grid; gap: .3rem 2rem;
  grid-template-columns: minmax(0, 1fr); align-items: start; align-content: start; }
.answer figure { padding: 0; }
@media screen and (min-width: 60rem) {
  .answer { grid-template-columns: minmax(0, 1.15fr) minmax(0, 1fr); line-height: 1.4; }
  .answer figure svg { max-height: 24rem; } /* what to do stays on the first screen */
}
@media screen and (width < 60rem) { /* one column: what to do comes before what ends first */
  .answer-words, .answer-side { display: contents; }
  .answer-verdict { order: -3; }
  .answer figure { order: -2; }
  .answer-ranking { order: -1; }
  .answer-first { order: 1; }
}
.answer p, .answer ul { margin: .25rem 0; }
.answer ul { padding-left: 1.2rem; }
.answer h3 { margin: .5rem 0 .1rem; font-size: 1rem; }
.answer .answer-promise { font-size: 1.35rem; line-height: 1.3; font-weight: 600; }
.answer-why { opacity: .75; font-size: .875em; }
.answer-bar { display: grid; grid-template-columns: 11rem minmax(0, 1fr) 8.5rem; gap: 0 .7rem;
  align-items: center; margin: .3rem 0; }
.answer-bar .answer-why { grid-column: 1 / -1; }
.answer-size { font-size: .875em; }
@media (max-width: 40rem) {
  .answer { font-size: .875rem; line-height: 1.3; }
  .answer :is(p, ul, .answer-bar) { margin: .15rem 0; }
  .answer h3 { margin-top: .4rem; }
  .answer figure svg { max-height: 22rem; }
  .answer .answer-promise { font-size: 1.2rem; }
}
@media (max-width: 40rem), print {
  .answer-bar { grid-template-columns: 8rem minmax(0, 1fr) 7rem; }
}
@media print { /* columns, unlike cells of a grid, fill a page before the next begins */
  .answer, .answer-words, .answer-side { display: block; }
  .answer { columns: 2; column-gap: 8mm; }
  .answer :is(p, li, .answer-bar) { break-inside: avoid; }
}
"""
STYLE = Markup(_STYLE) + bars.STYLE

_BAR = Markup(
    '<div class="answer-bar"><span>{}</span>{}<span class="answer-size">{}</span>'
    '<span class="answer-why">{}</span></div>'
)
_MOST_BARS = 4
_SEEN = 0.05  # of the largest bar; a shorter one cannot be seen
_MOST_ELEMENTS = 2  # besides the first; of more, only the last
_MOST_NAMED = 3  # of inputs whose indices do not distinguish them


def fragment(answer: Answer, picture: str = "") -> Markup:
    """Return the answer as one element of a page.

    Parameters
    ----------
    answer : Answer
    picture : str, optional
        HTML: of the quantity that the study is about.
    """
    words = _block("words", [_verdict(answer), _ranking(answer), _first(answer)])
    side = _block("side", [Markup(picture), _to_do(answer)])
    return Markup('<div class="answer">{}{}</div>').format(words, side)


def notebook(answer: Answer) -> str:
    """Return the answer with its style, as a notebook shows it."""
    return str(Markup("<style>{}</style>{}").format(STYLE, fragment(answer)))


def sayings(quantities: Sequence[Quantity]) -> Markup:
    """Return what is known of some quantities, in sentences."""
    sentences = []
    for quantity in quantities:
        lines = [
            keyed_sentences.promise(quantity),
            keyed_sentences.basis(quantity),
            keyed_sentences.likely(quantity),
        ]
        lines += [
            *keyed_sentences.events(quantity),
            keyed_sentences.leader(quantity),
            keyed_sentences.repeated(quantity),
        ]
        lines += keyed_sentences.earliest(quantity)
        items = Markup("").join(Markup("<li>{}</li>").format(line) for line in lines if line)
        title = capitalized(quantity.words)
        sentences.append(Markup("<h3>{}</h3><ul>{}</ul>").format(plain(printed(title)), items))
    return Markup("").join(sentences)


def regimes(answer: Answer) -> Markup:
    """Return the shares of the regimes, and what decides them."""
    items = (
        Markup("<li>{}</li>").format(keyed_sentences.regime(regime)) for regime in answer.regimes
    )
    return Markup("<ul>{}</ul>").format(Markup("").join(items)) if answer.regimes else Markup()


def _verdict(answer: Answer) -> Markup:
    lead = answer.lead
    parts = [] if lead is None else list(_of_lead(lead, answer))
    sentences = [
        keyed_sentences.enough(answer),
        keyed_sentences.levels(answer),
        folded.unsettled(answer),
    ]
    causes = [keyed_sentences.cause_of(cause) for cause in answer.regime_causes]
    shares = keyed_sentences.shares(answer.main_regimes)
    mixing = keyed_sentences.mixing(answer)
    if answer.regimes_first:
        parts = [
            _large(shares),
            _line(mixing) if mixing else mixing,
            *_under(sentences),
            *map(_line, causes),
            *parts,
        ]
    else:
        parts += [*_under(sentences), _line(shares) if shares else shares]
        decided = folded.items([*causes, answer.starts_alike])
        parts.append(folded.folded("What decides the regime", decided))
    parts.append(folded.folded("What it assumes", folded.items(answer.assumptions)))
    if answer.failed or lead is None:
        parts.insert(0, _line(keyed_sentences.rows(answer)))
    return _block("verdict", parts)


def _under(sentences: Sequence[Markup]) -> Iterator[Markup]:
    """Yield whether the rows are enough, which level decides, and what is to be unfolded."""
    again, levels, unsettled = sentences
    yield _line(levels) if levels else levels
    yield _small(again) if again else again
    yield unsettled


def _of_lead(lead: Quantity, answer: Answer) -> Iterator[Markup]:
    share, cause = keyed_sentences.first(lead)
    if verdict := keyed_sentences.promise(lead) or share:
        yield _line(verdict) if answer.regimes_first else _large(verdict)
    if cause:
        yield _line(cause)
    yield _small(lead.subject)
    if basis := keyed_sentences.basis(lead):
        yield _small(basis)
    if likely := keyed_sentences.likely(lead):
        yield _line(likely)
    yield from map(_line, keyed_sentences.others(lead))
    if answer.regimes_first:
        return
    elements = [element for element in answer.quantities[1:] if element.output == lead.output]
    promised = [
        quantity
        for quantity in elements
        if quantity.promise is not None and quantity.promise.sentence
    ]
    for other in promised if len(promised) <= _MOST_ELEMENTS else promised[-1:]:
        yield _small(
            Markup("{}: {}").format(plain(printed(other.place)), keyed_sentences.promise(other))
        )


def _ranking(answer: Answer) -> Markup:
    lead = answer.lead
    if lead is None or lead.ranking is None:
        return Markup()
    ranking = lead.ranking
    title = Markup("<h3>What it depends on</h3>{}").format(_levels(answer))
    if ranking.leader is None:
        why = keyed_sentences.leader(lead)
        if answer.regimes_first:
            why = Markup("{} {}").format(plain(printed(sentence(lead.words))), why)
        return _block("ranking", [title, _line(why)])
    note = _small(" ".join(filter(None, (sentence(ranking.index_meaning), answer.ties))))
    largest = ranking.contributions[0].value
    seen = [
        contribution
        for contribution in ranking.contributions
        if contribution.value >= _SEEN * largest
    ]
    shown = enumerate(seen[:_MOST_BARS])
    return _block("ranking", [title, *(_bar(lead, *bar) for bar in shown), note])


def _levels(answer: Answer) -> Markup:
    """Return the levels as bars, of a study that is about the regimes."""
    if answer.levels is None or not answer.regimes_first:
        return Markup()
    blocks = []
    for level in answer.levels.levels:
        track = bars.bar(level.share.value, level.share.low, level.share.high, (0.0, 1.0))
        size = Contribution(level.inputs, (level.share,), share_of_variance=True).size
        texts = capitalized(level.words), track, size, level.inputs_named
        blocks.append(_BAR.format(*map(_shown, texts)))
    return Markup("").join([*blocks, _small(f"Share of the variance of {answer.levels.subject}.")])


def _first(answer: Answer) -> Markup:
    """Return which rows of a life end first, and why."""
    lines = [] if answer.lead is None else [*map(_line, keyed_sentences.earliest(answer.lead))]
    title = Markup("<h3>What ends first</h3>")
    return _block("first", [title, *lines]) if lines else Markup()


def _bar(lead: Quantity, number: int, level: Contribution) -> Markup:
    """Return a contribution as a bar with its interval, its effect below."""
    assert lead.ranking is not None
    largest = lead.ranking.contributions[0].value
    most = largest if level.unit.name else max(1.0, largest)
    first = level.indices[0]
    track = bars.bar(level.value, first.low, first.high, (0.0, most))
    words, told = level.words, bool(level.effect)
    if len(level.inputs) > _MOST_NAMED:
        words, told = choices(map(called, level.inputs), _MOST_NAMED - 1), False
    return _BAR.format(
        plain(capitalized(words)),
        track,
        keyed_sentences.size(lead, number, level),
        keyed_sentences.effect(lead, number, level) if told else "",
    )


def _to_do(answer: Answer) -> Markup:
    if not answer.advice:
        return Markup()
    items = (
        Markup("<li>{}{}</li>").format(keyed_sentences.advice(advice), folded.below(advice))
        for advice in answer.advice
    )
    title = Markup("<h3>What to do</h3>")
    return _block("todo", [title, Markup("<ul>{}</ul>").format(Markup("").join(items))])


def _block(name: str, parts: list[Markup]) -> Markup:
    return Markup('<div class="answer-{}">{}</div>').format(name, Markup("").join(parts))


def _large(text: str) -> Markup:
    return Markup('<p class="answer-promise">{}</p>').format(_shown(text)) if text else Markup()


def _line(text: str) -> Markup:
    return Markup("<p>{}</p>").format(_shown(text))


def _small(text: str) -> Markup:
    return Markup('<p class="answer-why">{}</p>').format(_shown(text))


def _shown(text: str) -> str:
    return text if isinstance(text, Markup) else plain(printed(text))
