"""The answer as HTML, for a notebook and for the head of a report."""

from collections.abc import Iterator, Sequence

from markupsafe import Markup

from uq.assess.answer.answer_sentences import Answer
from uq.assess.answer.contributions import Contribution, whole_percent
from uq.assess.answer.piece_of_advice import Advice
from uq.assess.answer.quantities import Quantity
from uq.assess.answer.wording import called, scale_warning, sentence, share_text
from uq.errors import choices
from uq.render.html import cells
from uq.render.html.keyed_sentences import below, folded, items, joined, keyed, shown, with_keys
from uq.text.literals import plain
from uq.text.numbers import capitalized

_STYLE = """
.answer, .answer-words, .answer-side { display: grid; gap: .3rem 2rem;
  grid-template-columns: minmax(0, 1fr); align-items: start; align-content: start; }
@media screen and (min-width: 60rem) {
  .answer { grid-template-columns: minmax(0, 1.15fr) minmax(0, 1fr); line-height: 1.4; }
}
@media screen and (width < 60rem) { /* one column: what to do comes before what ends first */
  .answer-words, .answer-side { display: contents; }
  .answer-verdict { order: -3; }
  .answer-ranking { order: -1; }
  .answer-first { order: 1; }
}
.answer p, .answer ul { margin: .25rem 0; }
.answer ul { padding-left: 1.2rem; }
.answer h3 { margin: .5rem 0 .1rem; font-size: 1rem; }
.answer .answer-promise { font-size: 1.35rem; line-height: 1.3; font-weight: 600; }
.answer-why { opacity: .8; font-size: .875em; }
.warning { max-width: 48rem; margin: .5rem 0; padding: .5rem .75rem; border-left: 4px solid #d55e00;
  border-radius: 4px; background: rgba(213, 94, 0, .1); font-size: .875rem; font-weight: 600; }
.warning span { color: #d55e00; font-weight: 800; margin-right: .25rem; }
.answer-bar { display: grid; grid-template-columns: 11rem minmax(0, 1fr) 8.5rem; gap: 0 .7rem;
  align-items: center; margin: .3rem 0; }
.answer-bar .answer-why { grid-column: 1 / -1; }
.answer-size { font-size: .875em; }
@media (max-width: 40rem) {
  .answer { font-size: .875rem; line-height: 1.3; }
  .answer :is(p, ul, .answer-bar) { margin: .15rem 0; }
  .answer h3 { margin-top: .4rem; }
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
STYLE = Markup(_STYLE) + cells.STYLE

_BAR = Markup(
    '<div class="answer-bar"><span>{}</span>{}<span class="answer-size">{}</span>'
    '<span class="answer-why">{}</span></div>'
)
_MOST_BARS = 4
_SEEN = 0.05  # relative to the largest bar; a shorter bar is invisible
_MOST_ELEMENTS = 2  # besides the first; if there are more, only the last
_MOST_NAMED = 3  # of inputs whose indices do not distinguish them


def fragment(answer: Answer) -> Markup:
    """Return the answer as one element of a page."""
    words = _block("words", [_verdict(answer), _ranking(answer), _first(answer)])
    side = _block("side", [_to_do(answer)])
    return Markup('<div class="answer">{}{}</div>').format(words, side)


def notebook(answer: Answer) -> str:
    """Return the answer with its style sheet, for display in a notebook."""
    return str(Markup("<style>{}</style>{}").format(STYLE, fragment(answer)))


def sayings(answer: Answer, quantities: Sequence[Quantity]) -> Markup:
    """Return the given quantities of an answer in sentences."""
    sentences = []
    for quantity in quantities:
        place = _place(quantity)
        lines = [
            keyed(answer.fact, *place, "promise"),
            joined(_basis(quantity), keyed(answer.fact, *place, "own_error")),
            keyed(answer.fact, *place, "range"),
            *(
                _event(answer, *place, "events", event.name)
                for event in quantity.events
                if event.sentence
            ),
            _leader(answer, quantity),
            keyed(answer.fact, *place, "another_seed"),
            *_earliest(answer, quantity),
        ]
        title = shown(capitalized(quantity.words))
        sentences.append(Markup("<h3>{}</h3>{}").format(title, items(lines)))
    return Markup("").join(sentences)


def regimes(answer: Answer) -> Markup:
    """Return the shares of the regimes, and their main drivers."""
    events = [_event(answer, "regimes", regime.predicate) for regime in answer.regimes]
    return items(events)


def _place(quantity: Quantity) -> tuple[str, str]:
    return "quantities", quantity.name


def _basis(quantity: Quantity) -> Markup:
    """Return the kind of tolerance bound, or the reason why there is none."""
    return shown("" if quantity.tolerance_bound is None else quantity.tolerance_bound.basis)


def _event(answer: Answer, *place: str) -> Markup:
    """Return the probability of an event, its main driver, and the range where it is rare."""
    share = keyed(answer.fact, *place, "share")
    return joined(share, _cause(answer, *place))


def _cause(answer: Answer, *place: str) -> Markup:
    return joined(keyed(answer.fact, *place), keyed(answer.fact, *place, "limit"))


def _leader(answer: Answer, quantity: Quantity) -> Markup:
    """Return the largest contribution with its effect, or the reason why it is unknown."""
    place, ranking = (*_place(quantity), "ranking"), quantity.ranking
    sentence_of_leader = keyed(answer.fact, *place)
    if ranking is None or ranking.leader is None or not (ranking.leads and ranking.leader.effect):
        return sentence_of_leader
    text = sentence(ranking.leader.effect)
    effect = keyed(answer.fact, *place, "contributions", "0", "effects", text=text)
    return joined(sentence_of_leader, effect)


def _earliest(answer: Answer, quantity: Quantity) -> Iterator[Markup]:
    """Yield the inputs that distinguish the first rows to fail, and the command to show them."""
    if quantity.earliest is None:
        return
    place = (*_place(quantity), "earliest")
    if apart := keyed(answer.fact, *place):
        yield apart
    command = Markup("<code>{}</code>").format(plain(quantity.earliest.command))
    first = keyed(answer.fact, *place, "lives")
    yield Markup("{} Show the first: {}").format(first, command)


def _verdict(answer: Answer) -> Markup:
    lead, facts = answer.lead, answer.fact
    parts = [] if lead is None else list(_of_lead(lead, answer))
    again = keyed(facts, "enough")
    if lead is not None and not answer.regimes_first:  # the quantity shows the same number
        again = keyed(facts, *_place(lead), "another_seed", text=answer.enough.sentence)
    levels = joined(keyed(facts, "levels"), keyed(facts, "levels", "another_regime"))
    unsettled = items(answer.enough.others)
    sentences = [
        _line(levels),
        _small(again),
        folded("Other results not settled", unsettled),
    ]
    causes = [
        keyed(facts, "regimes", regime.predicate, text=regime.named_cause)
        for regime in answer.regime_causes
    ]
    shares = _shares(answer)
    if answer.regimes_first:
        mixing = keyed(facts, "intermingled")
        parts = [_large(shares), _line(mixing), *sentences, *map(_line, causes), *parts]
    else:
        parts += [*sentences, _line(shares)]
        decided = items([*causes, answer.starts_alike])
        parts.append(folded("Drivers of the regime", decided))
    parts.append(folded("Assumptions", items(answer.assumptions)))
    if answer.failed or lead is None:
        parts.insert(0, _line(keyed(facts)))
    return _block("verdict", parts)


def _shares(answer: Answer) -> Markup:
    """Return the shares of the main regimes in one sentence; "" if there are no regimes."""
    phrases = []
    for regime in answer.main_regimes:
        text = f"{share_text(regime.share)} {regime.predicate}"
        phrases.append(keyed(answer.fact, "regimes", regime.predicate, "share", text=text))
    return Markup("{}.").format(Markup(", ").join(phrases)) if phrases else Markup()


def _of_lead(lead: Quantity, answer: Answer) -> Iterator[Markup]:
    facts, place = answer.fact, _place(lead)
    verdict, cause = keyed(facts, *place, "promise"), Markup()
    if lead.first is not None:
        first = (*place, "events", lead.first.name)
        verdict, cause = keyed(facts, *first, "share"), _cause(answer, *first)
    yield _line(verdict) if answer.regimes_first else _large(verdict)
    yield warning(scale_warning(lead.scaled_by))
    yield _line(cause)
    yield _small(sentence(lead.words))
    yield _small(joined(_basis(lead), keyed(facts, *place, "own_error")))
    yield _line(keyed(facts, *place, "range"))
    for event in lead.others:
        if event.sentence:
            yield _line(_event(answer, *place, "events", event.name))
    if answer.regimes_first:
        return
    bounded = [
        quantity
        for quantity in answer.quantities[1:]
        if quantity.output == lead.output
        and quantity.tolerance_bound is not None
        and quantity.tolerance_bound.sentence
    ]
    for other in bounded if len(bounded) <= _MOST_ELEMENTS else bounded[-1:]:
        tolerance_bound = keyed(facts, *_place(other), "promise")
        yield _small(Markup("{}: {}").format(shown(other.place), tolerance_bound))


def _ranking(answer: Answer) -> Markup:
    lead = answer.lead
    if lead is None or lead.ranking is None:
        return Markup()
    ranking = lead.ranking
    title = Markup("<h3>Causes of the scatter</h3>{}").format(_levels(answer))
    if ranking.leader is None:
        why = _leader(answer, lead)
        if answer.regimes_first:
            why = Markup("{} {}").format(shown(sentence(lead.words)), why)
        return _block("ranking", [title, Markup("<p>{}</p>").format(why)])
    note = _small(" ".join(filter(None, (sentence(ranking.index_meaning), answer.ties))))
    largest = ranking.contributions[0].value
    seen = [
        contribution
        for contribution in ranking.contributions
        if contribution.value >= _SEEN * largest
    ]
    shown_bars = enumerate(seen[:_MOST_BARS])
    return _block("ranking", [title, *(_bar(answer, lead, *bar) for bar in shown_bars), note])


def _levels(answer: Answer) -> Markup:
    """Return the variance components by level as bars, for a study about regimes."""
    if answer.levels is None or not answer.regimes_first:
        return Markup()
    blocks = []
    for level in answer.levels.levels:
        track = cells.bar(level.share.value, level.share.low, level.share.high, (0.0, 1.0))
        texts = capitalized(level.words), track, whole_percent(level.share), level.inputs_named
        blocks.append(_BAR.format(*map(shown, texts)))
    return Markup("").join([*blocks, _small(sentence(f"share of {answer.levels.variance}"))])


def _first(answer: Answer) -> Markup:
    """Return the block on the first rows to fail, with the inputs that distinguish them."""
    lines = [] if answer.lead is None else [*map(_line, _earliest(answer, answer.lead))]
    title = Markup("<h3>Earliest failures</h3>")
    return _block("first", [title, *lines]) if lines else Markup()


def _bar(answer: Answer, lead: Quantity, number: int, level: Contribution) -> Markup:
    """Return a contribution as a bar with its interval and, below it, its effect."""
    assert lead.ranking is not None
    largest = lead.ranking.contributions[0].value
    most = largest if level.unit.name else max(1.0, largest)
    first = level.indices[0]
    track = cells.bar(level.value, first.low, first.high, (0.0, most))
    place = (*_place(lead), "ranking", "contributions", str(number))
    words, effect = level.words, keyed(answer.fact, *place, "effects")
    if len(level.inputs) > _MOST_NAMED:
        words, effect = choices(map(called, level.inputs), _MOST_NAMED - 1), Markup()
    size = keyed(answer.fact, *place, "inputs")
    return _BAR.format(plain(capitalized(words)), track, size, effect)


def _to_do(answer: Answer) -> Markup:
    if not answer.advice:
        return Markup()
    entries = (
        Markup("{}{}").format(_advice(answer, key, advice), below(advice))
        for key, advice in answer.advice_by_key.items()
    )
    return _block("todo", [Markup("<h3>What to do</h3>"), items(entries)])


def _advice(answer: Answer, key: str, advice: Advice) -> Markup:
    """Return one recommendation with its alternatives."""
    if not advice.key:
        has_number = advice.rows is not None
        return keyed(answer.fact, "advice", key) if has_number else shown(advice.sentence)
    sure = [] if advice.sure is None else [with_keys(advice.sure.bound_sentence, advice.sure.key)]
    worse = (with_keys(harm.besides, harm.key) for harm in advice.harmed)
    also = with_keys(advice.also, *(tolerance.key for tolerance in advice.alike))
    return joined(with_keys(advice.sentence, advice.key), *sure, *worse, also)


def _block(name: str, parts: list[Markup]) -> Markup:
    return Markup('<div class="answer-{}">{}</div>').format(name, Markup("").join(parts))


def warning(clause: str) -> Markup:
    """Return a warning that stands beside the numbers that it limits; "" without one."""
    if not clause:
        return Markup()
    text = shown(sentence(clause))
    return Markup('<p class="warning"><span aria-hidden="true">!</span> {}</p>').format(text)


def _large(text: str) -> Markup:
    return Markup('<p class="answer-promise">{}</p>').format(shown(text)) if text else Markup()


def _line(text: str) -> Markup:
    return Markup("<p>{}</p>").format(shown(text)) if text else Markup()


def _small(text: str) -> Markup:
    return Markup('<p class="answer-why">{}</p>').format(shown(text)) if text else Markup()
