"""What a machine proposes to a new study of it: laws, leading outputs, and the name of a row."""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from uq.contract import ROW_NAME, Parameter
from uq.sampling.input_faults import InputFault, unknown

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

    @classmethod
    def of_file(cls, file: Any) -> "StudyDefaults":
        """Return what a machine file proposes, of a program or of an FMU."""
        return cls(file.machine.row_name, file.machine.headline, file.uncertain)

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
            elif fault := _law_fault(name, law, parameters[name]):
                yield fault.line


def _are_texts(names: object) -> bool:
    return isinstance(names, list | tuple) and all(isinstance(name, str) for name in names)


def _law_fault(name: str, entry: Any, parameter: Parameter) -> InputFault | None:
    """Return the fault of a law, as in a study file; None if the parameter can have it."""
    from pydantic import ValidationError

    from uq.sampling.laws import LAWS, law_fault, law_of
    from uq.sampling.truncation import law_problem

    try:
        fault = law_problem(law_of(entry), parameter)
    except ValidationError as invalid:
        error: dict[str, Any] = dict(invalid.errors(include_url=False)[0])
        kind, *place = error["loc"] or ("",)
        return law_fault({**error, "loc": ("uncertain", name, *place)}, LAWS.get(str(kind)))
    return fault and fault.within("uncertain", name)
