"""A result: the Dataset of its rows, with its attributes parsed once."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import ROW_NAME, Floats, Mask, Output
from uq.errors import InputError, choices, nearest
from uq.result.element import Element
from uq.result.elements import (
    category_codes,
    dependence_of,
    elements_of,
    flags,
    has_independent_samples,
    independent_rows,
    named_elements,
    thinned_outputs,
    weights_of,
    why_no_statistics,
)
from uq.result.nesting import (
    Nesting,
    first_samples,
    is_nested,
    nesting_of,
    one_of_each_sample,
    ranked_in_words,
    ranked_rows,
)
from uq.result.result_file import failed, file_of, model_option, open_result, refuse_empty, upgraded
from uq.result.variables import outputs_of
from uq.result.weights import (
    has_next_rows,
    has_rounds,
    has_weights,
    refuse_if_weighted,
    row_weights,
    sample_weights,
    stand_for_any_unit,
)
from uq.sampling.designs import DESIGNS, Design
from uq.sampling.levels import CHANCE, LEVELS
from uq.stats.dependent_rows import Dependence
from uq.stats.importance_weights import ImportanceWeights
from uq.study.file import AnalysisTable, StudyFile, Tied
from uq.study.installed_models import FIELD_RECORD
from uq.study.reading import study_of_result
from uq.text.numbers import counted
from uq.text.units import ReadableUnit, typical, unit_of


class Result:
    """A Dataset of the rows of a study with their outputs, and its parsed attributes.

    Parameters
    ----------
    dataset : xarray.Dataset
        A result, or some rows of one. It must not be changed while this is in use: properties are
        computed once.
    """

    def __init__(self, dataset: xr.Dataset):
        self.dataset = dataset
        self._input_units: dict[str, ReadableUnit] = {}

    @classmethod
    def of(cls, source: "AnyResult") -> "Result":
        """Return the result that a path, a Dataset or a Result refers to.

        Raises
        ------
        InputError
            When it is none of these, or the file is not a result.
        """
        if isinstance(source, Result):
            return source
        if isinstance(source, xr.Dataset):
            return cls(upgraded(source))
        if isinstance(source, str | Path):
            return cls.open(source)
        raise InputError(
            f"not a result: {type(source).__name__} (allowed: a path, an xarray.Dataset)"
        )

    @classmethod
    def open(cls, path: str | Path) -> "Result":
        """Open a result and check its schema (`uq.result.result_file.open_result`)."""
        return cls(open_result(path))

    def __len__(self) -> int:
        """Return the number of rows."""
        return self.dataset.sizes["row"]

    def take(self, rows: slice | Sequence[int] | NDArray[Any]) -> "Result":
        """Return the selected rows: a slice, a mask or positions."""
        return Result(self.dataset.isel(row=rows))

    # The study and its design

    @cached_property
    def study(self) -> StudyFile:
        """The study file, its quantities in the units of the outputs."""
        units = {name: output.unit for name, output in self.outputs.items()}
        return study_of_result(self.dataset.attrs["study"]).in_units(units)

    @property
    def analysis(self) -> AnalysisTable:
        """The [analysis] of the study."""
        return self.study.analysis

    def analysis_of(self, output: str | None) -> AnalysisTable:
        """Return the [analysis] of the study, restricted to one output if it is named."""
        if output is None:
            return self.analysis
        thresholds = {name: at for name, at in self.analysis.thresholds.items() if name == output}
        return self.analysis.model_copy(update={"outputs": (output,), "thresholds": thresholds})

    @property
    def design_name(self) -> str:
        """The name of the design, ``monte-carlo``."""
        return str(self.dataset.attrs["design"])

    @property
    def design(self) -> Design:
        """The design of the rows."""
        return DESIGNS[self.design_name]

    @property
    def is_field_record(self) -> bool:
        """Whether the rows are lives from the field, which no model computed."""
        return self.dataset.attrs["model"] == FIELD_RECORD

    def refuse_if_record(self, question: str) -> None:
        """Refuse a question that lives from the field cannot answer, as no model computed them.

        Raises
        ------
        InputError
        """
        if self.is_field_record:
            raise InputError(
                f"{question}: {self.file} has lives from the field, which no model computed; ask it"
                " of a simulated study"
            )

    @property
    def recorded_life(self) -> Element:
        """The lifetime of a record of lives from the field."""
        (name,) = [name for name, declared in self.outputs.items() if declared.is_lifetime]
        return self.lifetimes(name)[0]

    def lifetime_like(self, record: "Result", name: str | None, option: str) -> Element:
        """Return the lifetime of a simulated study that the lives of a record are of.

        Parameters
        ----------
        record : Result
            Lives from the field.
        name : str or None
            By default the lifetime of the same name, or the only one shown.
        option : str
            Command-line option that gives the name, for messages.

        Raises
        ------
        InputError
            When the lifetime is not named and not unique, or in another unit.
        """
        mine = record.recorded_life
        names = [e.name for e in self.elements(self.shown_outputs(self.analysis)) if e.is_lifetime]
        if name is None and mine.name not in names and len(names) != 1:
            raise InputError(
                f"which lifetime are the lives '{mine.name}' of? Add {option} NAME"
                f" (allowed: {choices(names)})"
            )
        name = name or (mine.name if mine.name in names else names[0])
        element, *others = self.lifetimes(name)
        if others:
            raise InputError(f"{option} {name}: name one element, such as '{element.name}'")
        if mine.units != element.units:
            raise InputError(
                f"the lives '{mine.name}' are in '{mine.units}', '{element.name}' in"
                f" '{element.units}'; import them again with --unit"
            )
        return element

    @property
    def is_random(self) -> bool:
        """Whether rows of the model depend on their seeds."""
        return bool(self.dataset.attrs.get("random"))

    @property
    def row_name(self) -> tuple[str, str]:
        """Singular and plural of what a row represents: ``rod``, ``rods``."""
        singular, _, plural = str(self.dataset.attrs.get("row_name", "")).partition("/")
        return (singular, plural) if plural else ROW_NAME

    def counted_rows(self, count: int) -> str:
        """Return a number of rows by the name of what they represent: ``6 000 rods``."""
        return counted(count, *self.row_name)

    # Outputs and inputs

    @cached_property
    def outputs(self) -> Mapping[str, Output]:
        """The outputs as their variables declare them, by name and in order."""
        return outputs_of(self.dataset)

    @property
    def output_names(self) -> tuple[str, ...]:
        """The names of all outputs."""
        return tuple(self.outputs)

    def shown_outputs(self, analysis: AnalysisTable) -> tuple[str, ...]:
        """Return the outputs that an [analysis] names, or all if it names none."""
        if not analysis.outputs:
            return tuple(name for name, output in self.outputs.items() if output.shown)
        named = (*analysis.outputs, *analysis.thresholds, *analysis.joint_bounds)
        return tuple(dict.fromkeys(named))

    def is_category(self, name: str) -> bool:
        """Whether there is a category of this name."""
        return name in self.outputs and self.outputs[name].is_category

    def codes(self, name: str) -> dict[str, NDArray[np.int8]]:
        """Return the codes of a category by element (`uq.result.elements.category_codes`)."""
        return category_codes(self.dataset, name)

    def elements(self, outputs: Sequence[str], every: bool = False) -> Iterator[Element]:
        """Yield the elements of outputs (`uq.result.elements.elements_of`)."""
        return elements_of(self.dataset, outputs, every, self.outputs, self.failed)

    def named_elements(self, name: str) -> list[Element]:
        """Return the elements that a name refers to (`uq.result.elements.named_elements`)."""
        return named_elements(self.dataset, name)

    def lifetimes(self, name: str) -> list[Element]:
        """Return the elements of a lifetime that a name refers to (`named_elements`).

        Raises
        ------
        InputError
            When there is no such output or element, or it is not a lifetime.
        """
        elements = self.named_elements(name)
        if not elements[0].is_lifetime:
            lives = [life for life, output in self.outputs.items() if output.is_lifetime]
            raise InputError(f"'{name}' is not a lifetime (lifetimes: {choices(lives)})")
        return elements

    @property
    def notes_on_places(self) -> list[str]:
        """Sentences on outputs with only selected elements shown."""
        return [
            f"{name}: shown at evenly spread places, as it has {size} elements; name it in"
            " [analysis] outputs for all of them"
            for name, size in thinned_outputs(self.dataset).items()
        ]

    def input_unit(self, name: str) -> ReadableUnit:
        """Return the unit in which an input is read, in all sentences, tables and figures."""
        if name not in self._input_units:
            variable = self.dataset[name]
            units = str(variable.attrs["units"])
            size = 0.0 if units == "1" else typical(variable.values.ravel())  # 1 has no prefix
            self._input_units[name] = unit_of(units, size)
        return self._input_units[name]

    # Rows: outcome, dependence and weights

    @cached_property
    def failed(self) -> Mask:
        """Mask of rows that failed, shape (n,)."""
        return failed(self.dataset)

    def refuse_empty(self) -> None:
        """Refuse a result without rows.

        Raises
        ------
        InputError
        """
        refuse_empty(self.dataset)

    @cached_property
    def independent(self) -> "Result":
        """The rows for plain statistics (`uq.result.elements.independent_rows`).

        Raises
        ------
        InputError
            When there are no rows at all.
        """
        rows = independent_rows(self.dataset)
        return self if rows is self.dataset else Result(rows)

    @cached_property
    def why_no_statistics(self) -> str:
        """Why the rows do not support plain statistics (a predicate), or ""."""
        return why_no_statistics(self.dataset)

    @cached_property
    def dependence(self) -> Dependence:
        """The dependence between rows (`uq.result.elements.dependence_of`)."""
        return dependence_of(self.dataset)

    @property
    def has_independent_rows(self) -> bool:
        """Whether rows (blocks A and B of a crossed design) are independent."""
        return self.has_independent_samples and not self.is_nested

    @property
    def has_independent_samples(self) -> bool:
        """Whether samples are independent, however many rows each has."""
        return has_independent_samples(self.dataset)

    @property
    def has_weights(self) -> bool:
        """Whether inspections, or the choice of next rows, have weighted the rows."""
        return has_weights(self.dataset)

    @property
    def has_next_rows(self) -> bool:
        """Whether rows have weights since 'uq extend --next' drew some of them."""
        return has_next_rows(self.dataset)

    @property
    def has_rounds(self) -> bool:
        """Whether a sampler has added rows to those of the design."""
        return has_rounds(self.dataset)

    @property
    def row_weights(self) -> Floats | None:
        """The weights of rows, of mean 1 (`uq.result.weights.row_weights`)."""
        return row_weights(self.dataset)

    @cached_property
    def weights(self) -> ImportanceWeights | None:
        """The weights of rows with their quality (`uq.result.elements.weights_of`)."""
        return weights_of(self.dataset)

    def sample_weights(self, question: str) -> Floats | None:
        """Return the weights of samples whose units were not inspected (`sample_weights`)."""
        return sample_weights(self.dataset, self.nesting, question)

    @property
    def stands_for_any_unit(self) -> bool:
        """Whether rows represent any unit: no inspection concerns the units."""
        return stand_for_any_unit(self.dataset)

    def refuse_if_weighted(self, question: str) -> None:
        """Refuse a question that weighted rows cannot answer.

        Raises
        ------
        InputError
        """
        refuse_if_weighted(self.dataset, question)

    # Samples, units, repeats, and parts of the rows

    @cached_property
    def nesting(self) -> Nesting:
        """The indices of rows in samples, units and repeats."""
        return nesting_of(self.dataset)

    @property
    def is_nested(self) -> bool:
        """Whether samples have several rows."""
        return is_nested(self.dataset)

    @property
    def levels(self) -> dict[str, str]:
        """The level of each input, by name."""
        return {name: level for name, (_, level) in self._leaders.items()}

    def levels_that_vary(self, without: Collection[str] = ()) -> Sequence[str]:
        """Return the levels on which rows vary; a random model also varies by its seeds.

        Parameters
        ----------
        without : collection of str
            Inputs to ignore, as well as the inputs that equal them.
        """
        levels = {level for leader, level in self._leaders.values() if leader not in without}
        if self.is_random:
            levels.add(CHANCE)
        return [level for level in LEVELS if level in levels]

    @property
    def _leaders(self) -> dict[str, tuple[str, str]]:
        """The leader of each input (the input that it equals, or itself) and its level."""
        entries = self.study.uncertain
        leaders = {
            name: entry.equals if isinstance(entry, Tied) else name
            for name, entry in entries.items()
        }
        laws = {name: entry for name, entry in entries.items() if not isinstance(entry, Tied)}
        return {name: (leader, laws[leader].level) for name, leader in leaders.items()}

    @property
    def first_rows(self) -> "Result":
        """The first repeat of the first unit of each sample: they follow a plain design."""
        rows = one_of_each_sample(self.dataset)
        return self if rows is self.dataset else Result(rows)

    def first_samples(self, samples: int) -> "Result":
        """Return the rows of the first samples of each replicate."""
        return Result(first_samples(self.dataset, samples))

    @cached_property
    def ranked(self) -> "Result":
        """The rows that rank inputs (`uq.result.nesting.ranked_rows`)."""
        rows = ranked_rows(self.dataset)
        return self if rows is self.dataset else Result(rows)

    @property
    def ranked_in_words(self) -> str:
        """A phrase for the rows that are ranked, ``by the first 50 000 rows``; "" for all."""
        return ranked_in_words(self.ranked.dataset, self.dataset)

    def within_regime(self, regime: str) -> "Result":
        """Return the rows in one regime.

        Failed rows without a regime are kept: any of them might have been in this one, and failed
        rows must be counted.

        Raises
        ------
        InputError
            When the result has no regimes, this one does not exist, or no row is in it.
        """
        if "regime" not in self.dataset:
            raise InputError("this result has no regimes; leave the regime out")
        variable = self.dataset["regime"]
        codes = {label: code for code, label in flags(variable) if code >= 0}
        if regime not in codes:
            near, allowed = nearest(regime, list(codes)), ", ".join(codes)
            raise InputError(f"no such regime '{regime}'{near} (allowed: {allowed})")
        in_regime = variable.values == codes[regime]
        if not in_regime.any():
            present = np.unique(variable.values)
            occurring = [label for label, code in codes.items() if code in present]
            raise InputError(
                f"no row is in the regime '{regime}' (there are rows in: {choices(occurring)})"
            )
        return self.take(np.flatnonzero(in_regime | ((variable.values < 0) & self.failed)))

    # Commands on the file

    @property
    def file(self) -> str:
        """The file as a shell reads it, OUT if it is not recorded."""
        return file_of(self.dataset)

    @property
    def model_option(self) -> str:
        """``--model`` and a file, after a blank, for a model that is not installed here."""
        return model_option(self.dataset)


AnyResult = Result | xr.Dataset | str | Path
"""Types accepted as a result by public functions."""
