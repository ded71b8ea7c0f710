"""What a machine proposes to a new study of it: laws, leading outputs, and the name of a row."""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from uq.contract import ROW_NAME, Parameter
from uq.errors import nearest
from uq.sampling.input_faults import fault_of, unknown

_WORDS = re.compile(r"[^\W\d_]([\w -]{0,20}\w)?")


class StudyDefaults(NamedTuple):
    """What a machine proposes to a new study of it; see `uq.contract.Model`.

    Attributes
    ----------
    row_name : sequence of str
        Singular and plural of what a row represents.
    headline : sequence of str
        Outputs that a new study reports, the most important first.
    uncertain : dict of str to dict
        Input -> its law in a new study, as in a study file.
    """

    row_name: Sequence[str] = ROW_NAME
    headline: Sequence[str] = ()
    uncertain: Mapping[str, Mapping[str, Any]] = {}

    def faults(
        self, parameters: Mapping[str, Parameter], outputs: Collection[str]
    ) -> Iterator[str]:
        """Yield what cannot be used; without known outputs the headline is not checked."""
        names = self.row_name
        if not _are_texts(names) or len(names) != 2 or not all(map(_WORDS.fullmatch, names)):
            yield (
                f"row_name = {names!r}: must be a singular and a plural, such as ('pump', 'pumps')"
            )
        if not _are_texts(self.headline):
            yield f"headline = {self.headline!r}: must be a list of outputs"
        elif outputs:
            for name in self.headline:
                if name not in outputs:
                    yield f"headline: '{name}': {unknown('output', name, outputs)}"
        if not isinstance(self.uncertain, Mapping):
            yield f"uncertain = {self.uncertain!r}: must be a table of laws"
            return
        for name, law in self.uncertain.items():
            if name not in parameters:
                yield f"uncertain: '{name}': {unknown('parameter', name, parameters)}"
            elif problem := _law_fault(law, parameters[name]):
                yield f"uncertain: {name}: {problem}"


def _are_texts(names: object) -> bool:
    return isinstance(names, list | tuple) and all(isinstance(name, str) for name in names)


def _law_fault(entry: Any, parameter: Parameter) -> str:
    """Return the fault of a law in words; "" if the parameter can have it."""
    from pydantic import ValidationError

    from uq.sampling.laws import LAWS, law_of
    from uq.sampling.truncation import law_problem

    kind = entry.get("distribution") if isinstance(entry, Mapping) else None
    if not isinstance(kind, str) or kind not in LAWS:
        near = nearest(kind, LAWS) if isinstance(kind, str) else ""
        return f"needs a distribution{near} (one of {', '.join(LAWS)})"
    try:
        fault = law_problem(law_of(dict(entry)), parameter)
    except ValidationError as invalid:
        error: dict[str, Any] = dict(invalid.errors(include_url=False)[0])
        place = tuple(error["loc"])[1:]  # pydantic begins with the name of the law
        keys = list(LAWS[kind].model_fields)
        fault = fault_of({**error, "loc": place}, lambda path: ("argument", keys))
    if fault is None:
        return ""
    return f"{'.'.join(map(str, fault.path))} {fault.problem}".strip()
