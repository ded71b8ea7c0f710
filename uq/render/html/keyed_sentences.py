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
    found = "\n".join(keys)
    return Markup('<span data-trace="{0}" title="uq trace: {0}">{1}</span>').format(
        plain(found), plain(printed(text))
    )


def rows(one: Answer) -> Markup:
    """Return how many rows were computed."""
    return keyed(one.rows_sentence, _answer("rows"), _answer("failed"))


def promise(one: Quantity) -> Markup:
    """Return what can be promised; "" where nothing can."""
    return keyed("" if one.promise is None else one.promise.sentence, _key(one, "promise"))


def basis(one: Quantity) -> Markup:
    """Return what kind of bound is promised, and what the rows' own error would do to it."""
    kind = "" if one.promise is None else one.promise.basis
    error = "" if one.own_error is None else one.own_error.sentence
    said = [escape(plain(printed(kind))), keyed(error, _key(one, "own_error"))]
    return Markup(" ").join(filter(None, said))


def likely(one: Quantity) -> Markup:
    """Return the likely range; "" where it is not known."""
    return keyed("" if one.range is None else one.range.sentence, _key(one, "range"))


def repeated(one: Quantity) -> Markup:
    """Return what another seed would find; "" where that is not known."""
    return _again(one.repeated.sentence, one.repeated, _key(one, "another_seed", "expected"))


def enough(one: Answer) -> Markup:
    """Return whether the rows are enough, and what another seed would find."""
    key = _answer("enough", "expected")
    if one.lead is not None and not one.regimes_first:
        key = _key(one.lead, "another_seed", "expected")
    return _again(one.enough.sentence, one.enough.again, key)


def _again(text: str, known: PredictionInterval, key: str) -> Markup:
    return keyed(text, key) if known.subject else escape(plain(printed(text)))


def mixing(one: Answer) -> Markup:
    """Return that the regimes are intermingled, where they are."""
    return keyed(one.mixing.sentence, _answer("intermingled", "left"))


def levels(one: Answer) -> Markup:
    """Return which level decides, as far as that is known."""
    if (found := one.levels) is None:
        return Markup()
    shares = (_answer("levels", "shares", each.name, "value") for each in found.levels)
    another = keyed(found.switching, _answer("levels", "another_regime", "value"))
    return Markup(" ").join(filter(None, (keyed(found.sentence, *shares), another)))


def events(one: Quantity) -> list[Markup]:
    """Return the probabilities that are known, and what decides them."""
    return [_event(each, _path(one, each)) for each in one.events if each.sentence]


def others(one: Quantity) -> list[Markup]:
    """Return the same of the events that do not stand first."""
    return [_event(each, _path(one, each)) for each in one.others if each.sentence]


def first(one: Quantity) -> tuple[Markup, Markup]:
    """Return the probability that stands first, and what decides it; "" where there is none."""
    if one.first is None:
        return Markup(), Markup()
    path = _path(one, one.first)
    cause = filter(None, (_cause(one.first, path), _limit(one.first, path)))
    return _share(one.first, path), Markup(" ").join(cause)


def regime(one: Event) -> Markup:
    """Return the share of a regime, and what decides it."""
    return _event(one, ("regimes", one.predicate))


def cause_of(one: Event) -> Markup:
    """Return what decides a regime, after its name."""
    return keyed(one.named_cause, _answer(*_cause_key(one, ("regimes", one.predicate))))


def shares(several: Sequence[Event]) -> Markup:
    """Return the shares of regimes in one sentence; "" without any."""
    known = [
        keyed(
            f"{share_text(one.share)} {one.predicate}", _answer("regimes", one.predicate, "share")
        )
        for one in several
    ]
    return Markup("{}.").format(Markup(", ").join(known)) if known else Markup()


def _event(one: Event, path: Path) -> Markup:
    known = (_share(one, path), _cause(one, path), _limit(one, path))
    return Markup(" ").join(filter(None, known))


def _share(one: Event, path: Path) -> Markup:
    return keyed(one.sentence, _answer(*path, "share"))


def _cause(one: Event, path: Path) -> Markup:
    return keyed(one.decided_by, _answer(*_cause_key(one, path)))


def _cause_key(one: Event, path: Path) -> Path:
    return (*path, "decided_by") if one.curve is not None else (*path, "ranking", "rows_factor")


def _limit(one: Event, path: Path) -> Markup:
    of = None if one.limit is None else "value" if one.limit.why else "at"
    return Markup() if of is None else keyed(one.limited, _answer(*path, "limit", of))


def _path(one: Quantity, of: Event) -> Path:
    return ("quantities", one.name, "events", of.name)


def leader(one: Quantity) -> Markup:
    """Return what contributes most, with direction and size, or why that is not known."""
    ranking = one.ranking
    if ranking is None:
        return Markup()
    if ranking.leader is None:
        return keyed(ranking.sentence, _key(one, "ranking", "rows_factor"))
    keys = _keys(one, 0, "inputs", ranking.leader)
    keys += [_key(one, "ranking", "unexplained")] * bool(ranking.beyond_single)
    sentences = [keyed(ranking.sentence, *keys)]
    if ranking.leads and ranking.leader.effect:
        text = sentence(ranking.leader.effect)
        sentences.append(keyed(text, *_keys(one, 0, "effects", ranking.leader)))
    return Markup(" ").join(sentences)


def earliest(one: Quantity) -> Iterator[Markup]:
    """Yield what distinguishes the rows that end first, and which these are."""
    if (said := one.earliest) is None:
        return
    if said.sentence:
        apart = [("inputs", each.name) for each in said.inputs or ()]
        apart += [("regimes", each.label) for each in said.regimes]
        yield keyed(said.sentence, *(_key(one, "earliest", *each) for each in [("size",), *apart]))
    command = Markup("<code>{}</code>").format(plain(said.command))
    first = keyed(said.first, _key(one, "earliest", "lives"))
    yield Markup("{} To see the first: {}").format(first, command)


def size(one: Quantity, number: int, of: Contribution) -> Markup:
    """Return the indices of a contribution, which has this number."""
    return keyed(of.size, *_keys(one, number, "inputs", of))


def effect(one: Quantity, number: int, of: Contribution) -> Markup:
    """Return directions and sizes of a contribution, which has this number."""
    return keyed(of.effect, *_keys(one, number, "effects", of))


def advice(one: Advice) -> Markup:
    """Return one thing to do."""
    if one.key:
        sure = Markup() if one.sure is None else keyed(one.sure.promised, one.sure.key)
        worse = (keyed(each.besides, each.key) for each in one.harmed)
        also = keyed(one.also, *(each.key for each in one.alike))
        said = keyed(one.sentence, one.key)
        return Markup(" ").join(filter(None, (said, sure, *worse, also)))
    if one.rows is not None:
        return keyed(one.sentence, _answer("advice", one.rule, "rows"))
    return escape(plain(printed(one.sentence)))


def _key(one: Quantity, *path: str) -> str:
    return _answer("quantities", one.name, *path)


def _keys(one: Quantity, number: int, part: str, of: Contribution) -> list[str]:
    """Return the keys of the inputs of a contribution."""
    path = ("ranking", "contributions", str(number), part)
    return [_key(one, *path, name) for name in of.inputs]


def _answer(*path: str) -> str:
    return key_of(*path, verb="answer")
