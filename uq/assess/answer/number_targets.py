"""The subject of a number of a result, by the name that a person reads."""

from uq.assess.answer.wording import element_called
from uq.assess.targets import split_name
from uq.result.result import Result
from uq.text.numbers import compared, estimated
from uq.text.symbols import readable


class NumberTarget:
    """An element of an output, or a quantity derived from it.

    Parameters
    ----------
    ds : xarray.Dataset
    name : str
        As `uq.sensitivity` returns it.

    Attributes
    ----------
    name : str
        Its readable name, also accepted by ``--output``: ``P(life < 24 hours)``.
    units : str
        CF unit of the numbers; ``"1"`` for those of a logarithm, a rank or an event.
    meaning : str
        Of the element, with its place.
    """

    def __init__(self, result: Result, name: str):
        form, inside, _ = split_name(name)
        output = inside.partition("=" if "[" not in inside else "[")[0]
        self.name, self.units, self.meaning = name, "1", ""
        self._compared, self._asked = "", result.analysis.thresholds.get(output, ())
        if result.is_category(output):
            self.meaning = str(result.dataset[output].attrs["long_name"])
        elif output in (outputs := result.outputs):
            element, *others = result.named_elements(inside)
            declared = outputs[output]
            self._units = declared.unit
            self._compared = compared(inside, declared.is_angle)
            self.meaning = element_called(result, element)
            if others:
                self.meaning = f"{readable(element.meaning)}, all {1 + len(others)} elements"
            self.units = "1" if form else declared.unit
            self.name = self.label(name)

    def label(self, label: str) -> str:
        """Return the name of one of its estimates for a person."""
        return estimated(label, self._units, self._compared, self._asked)
