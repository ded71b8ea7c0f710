"""Sentences of the answer as HTML, each with the keys of its numbers for ``uq trace``."""

from collections.abc import Iterator, Sequence

from markupsafe import Markup, escape

from uq.assess.answer.contributions import Contribution
from uq.assess.answer.facts import Answer
from uq.assess.answer.parts import Event, Quantity
from uq.assess.answer.remedies import Advice
from uq.assess.answer.repeat_interval import PredictionInterval
from uq.assess.answer.wording import sentence, share_text
from uq.text.keys import key_of
from uq.text.literals import plain
from uq.text.numbers import printed

Path = tuple[str, ...]


def keyed(text: str, *keys: str) -> Markup:
    """Return text that shows the keys of its numbers; "" if it is empty."""
    if not text:
        return Markup()
    lines = "\n".join(keys)
    return Markup('<span data-trace="{0}" title="uq trace: {0}">{1}</span>').format(
        plain(lines), plain(printed(text))
    )


def rows(answer: Answer) -> Markup:
    """Return how many rows were computed."""
    return keyed(answer.rows_sentence, _answer("rows"), _answer("failed"))


def promise(quantity: Quantity) -> Markup:
    """Return what can be promised; "" where nothing can."""
    return keyed(
        "" if quantity.promise is None else quantity.promise.sentence, _key(quantity, "promise")
    )


def basis(quantity: Quantity) -> Markup:
    """Return what kind of bound is promised, and what the rows' own error would do to it."""
    kind = "" if quantity.promise is None else quantity.promise.basis
    error = "" if quantity.own_error is None else quantity.own_error.sentence
    sentences = [escape(plain(printed(kind))), keyed(error, _key(quantity, "own_error"))]
    return Markup(" ").join(filter(None, sentences))


def likely(quantity: Quantity) -> Markup:
    """Return the likely range; "" where it is not known."""
    return keyed("" if quantity.range is None else quantity.range.sentence, _key(quantity, "range"))


def repeated(quantity: Quantity) -> Markup:
    """Return what another seed would find; "" where that is not known."""
    return _again(
        quantity.repeated.sentence, quantity.repeated, _key(quantity, "another_seed", "expected")
    )


def enough(answer: Answer) -> Markup:
    """Return whether the rows are enough, and what another seed would find."""
    key = _answer("enough", "expected")
    if answer.lead is not None and not answer.regimes_first:
        key = _key(answer.lead, "another_seed", "expected")
    return _again(answer.enough.sentence, answer.enough.again, key)


def _again(text: str, prediction: PredictionInterval, key: str) -> Markup:
    return keyed(text, key) if prediction.subject else escape(plain(printed(text)))


def mixing(answer: Answer) -> Markup:
    """Return that the regimes are intermingled, where they are."""
    return keyed(answer.mixing.sentence, _answer("intermingled", "left"))


def levels(answer: Answer) -> Markup:
    """Return which level decides, as far as that is known."""
    if (decomposition := answer.levels) is None:
        return Markup()
    shares = (_answer("levels", "shares", level.name, "value") for level in decomposition.levels)
    another = keyed(decomposition.switching, _answer("levels", "another_regime", "value"))
    return Markup(" ").join(filter(None, (keyed(decomposition.sentence, *shares), another)))


def events(quantity: Quantity) -> list[Markup]:
    """Return the probabilities that are known, and what decides them."""
    return [
        _event(sub_event, _path(quantity, sub_event))
        for sub_event in quantity.events
        if sub_event.sentence
    ]


def others(answer: Quantity) -> list[Markup]:
    """Return the same of the events that do not stand first."""
    return [_event(other, _path(answer, other)) for other in answer.others if other.sentence]


def first(answer: Quantity) -> tuple[Markup, Markup]:
    """Return the probability that stands first, and what decides it; "" where there is none."""
    if answer.first is None:
        return Markup(), Markup()
    path = _path(answer, answer.first)
    cause = filter(None, (_cause(answer.first, path), _limit(answer.first, path)))
    return _share(answer.first, path), Markup(" ").join(cause)


def regime(event: Event) -> Markup:
    """Return the share of a regime, and what decides it."""
    return _event(event, ("regimes", event.predicate))


def cause_of(event: Event) -> Markup:
    """Return what decides a regime, after its name."""
    return keyed(event.named_cause, _answer(*_cause_key(event, ("regimes", event.predicate))))


def shares(several: Sequence[Event]) -> Markup:
    """Return the shares of regimes in one sentence; "" without any."""
    phrases = [
        keyed(
            f"{share_text(event.share)} {event.predicate}",
            _answer("regimes", event.predicate, "share"),
        )
        for event in several
    ]
    return Markup("{}.").format(Markup(", ").join(phrases)) if phrases else Markup()


def _event(event: Event, path: Path) -> Markup:
    sentences = (_share(event, path), _cause(event, path), _limit(event, path))
    return Markup(" ").join(filter(None, sentences))


def _share(event: Event, path: Path) -> Markup:
    return keyed(event.sentence, _answer(*path, "share"))


def _cause(event: Event, path: Path) -> Markup:
    return keyed(event.decided_by, _answer(*_cause_key(event, path)))


def _cause_key(event: Event, path: Path) -> Path:
    return (*path, "decided_by") if event.curve is not None else (*path, "ranking", "rows_factor")


def _limit(event: Event, path: Path) -> Markup:
    of = None if event.limit is None else "value" if event.limit.why else "at"
    return Markup() if of is None else keyed(event.limited, _answer(*path, "limit", of))


def _path(quantity: Quantity, of: Event) -> Path:
    return ("quantities", quantity.name, "events", of.name)


def leader(quantity: Quantity) -> Markup:
    """Return what contributes most, with direction and size, or why that is not known."""
    ranking = quantity.ranking
    if ranking is None:
        return Markup()
    if ranking.leader is None:
        return keyed(ranking.sentence, _key(quantity, "ranking", "rows_factor"))
    keys = _keys(quantity, 0, "inputs", ranking.leader)
    keys += [_key(quantity, "ranking", "unexplained")] * bool(ranking.beyond_single)
    sentences = [keyed(ranking.sentence, *keys)]
    if ranking.leads and ranking.leader.effect:
        text = sentence(ranking.leader.effect)
        sentences.append(keyed(text, *_keys(quantity, 0, "effects", ranking.leader)))
    return Markup(" ").join(sentences)


def earliest(quantity: Quantity) -> Iterator[Markup]:
    """Yield what distinguishes the rows that end first, and which these are."""
    if (earliest_rows := quantity.earliest) is None:
        return
    if earliest_rows.sentence:
        apart = [("inputs", distinct.name) for distinct in earliest_rows.inputs or ()]
        apart += [("regimes", regime_share.label) for regime_share in earliest_rows.regimes]
        yield keyed(
            earliest_rows.sentence,
            *(_key(quantity, "earliest", *path) for path in [("size",), *apart]),
        )
    command = Markup("<code>{}</code>").format(plain(earliest_rows.command))
    first = keyed(earliest_rows.first, _key(quantity, "earliest", "lives"))
    yield Markup("{} To see the first: {}").format(first, command)


def size(quantity: Quantity, number: int, of: Contribution) -> Markup:
    """Return the indices of a contribution, which has this number."""
    return keyed(of.size, *_keys(quantity, number, "inputs", of))


def effect(quantity: Quantity, number: int, of: Contribution) -> Markup:
    """Return directions and sizes of a contribution, which has this number."""
    return keyed(of.effect, *_keys(quantity, number, "effects", of))


def advice(advice_given: Advice) -> Markup:
    """Return one thing to do."""
    if advice_given.key:
        sure = (
            Markup()
            if advice_given.sure is None
            else keyed(advice_given.sure.promised, advice_given.sure.key)
        )
        worse = (keyed(harm.besides, harm.key) for harm in advice_given.harmed)
        also = keyed(advice_given.also, *(similar.key for similar in advice_given.alike))
        proposal = keyed(advice_given.sentence, advice_given.key)
        return Markup(" ").join(filter(None, (proposal, sure, *worse, also)))
    if advice_given.rows is not None:
        return keyed(advice_given.sentence, _answer("advice", advice_given.rule, "rows"))
    return escape(plain(printed(advice_given.sentence)))


def _key(quantity: Quantity, *path: str) -> str:
    return _answer("quantities", quantity.name, *path)


def _keys(quantity: Quantity, number: int, part: str, of: Contribution) -> list[str]:
    """Return the keys of the inputs of a contribution."""
    path = ("ranking", "contributions", str(number), part)
    return [_key(quantity, *path, name) for name in of.inputs]


def _answer(*path: str) -> str:
    return key_of(*path, verb="answer")
