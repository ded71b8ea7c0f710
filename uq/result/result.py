"""A result: the Dataset of its rows with everything that its attributes declare, read once."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Floats, Mask, Output
from uq.errors import InputError
from uq.result import commands, elements, nesting, ranked_rows, regimes, result_file, variables
from uq.result import weights as row_weights
from uq.result.element import Element
from uq.result.nesting import Nesting
from uq.sampling.designs import DESIGNS, Design
from uq.stats.importance_weights import Smoothed
from uq.stats.intervals import Replicates
from uq.study.file import AnalysisTable, StudyFile
from uq.text.units import ReadableUnit


class Result:
    """The rows of a study with their outputs: a Dataset, and what its attributes mean.

    Parameters
    ----------
    dataset : xarray.Dataset
        A result, or some rows of one. It must not be changed while this is in use: properties are
        computed once.
    """

    def __init__(self, dataset: xr.Dataset):
        self.dataset = dataset

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
            return cls(result_file.upgraded(source))
        if isinstance(source, str | Path):
            return cls.open(source)
        raise InputError(
            f"not a result: {type(source).__name__} (allowed: a path, an xarray.Dataset)"
        )

    @classmethod
    def open(cls, path: str | Path) -> "Result":
        """Open a result and check its schema (`uq.result.result_file.open_result`)."""
        return cls(result_file.open_result(path))

    def __len__(self) -> int:
        """Return the number of rows."""
        return self.dataset.sizes["row"]

    def take(self, rows: slice | Sequence[int] | NDArray[Any]) -> "Result":
        """Return some rows: a slice, a mask or their places."""
        return Result(self.dataset.isel(row=rows))

    # The study and its design

    @cached_property
    def study(self) -> StudyFile:
        """The study file."""
        return elements.study_file_of(self.dataset)

    @property
    def analysis(self) -> AnalysisTable:
        """The [analysis] of the study."""
        return self.study.analysis

    def analysis_of(self, output: str | None) -> AnalysisTable:
        """Return the [analysis] of the study, restricted to one output if it is named."""
        return elements.analysis_of(self.dataset, output)

    @property
    def design_name(self) -> str:
        """The name of the design, ``monte-carlo``."""
        return str(self.dataset.attrs["design"])

    @property
    def design(self) -> Design:
        """The design of the rows."""
        return DESIGNS[self.design_name]

    @property
    def is_random(self) -> bool:
        """Whether rows of the model depend on their seeds."""
        return bool(self.dataset.attrs.get("random"))

    # Outputs and inputs

    @cached_property
    def outputs(self) -> Mapping[str, Output]:
        """The outputs as their variables declare them, by name and in order."""
        return variables.outputs_of(self.dataset)

    @property
    def output_names(self) -> tuple[str, ...]:
        """The names of all outputs."""
        return tuple(self.outputs)

    def shown_outputs(self, analysis: AnalysisTable) -> tuple[str, ...]:
        """Return the outputs that an [analysis] names, or all if it names none."""
        return elements.shown_outputs(self.dataset, analysis)

    def is_category(self, name: str) -> bool:
        """Whether there is a category of this name."""
        return variables.is_category(self.dataset, name)

    def codes(self, name: str) -> dict[str, NDArray[np.int8]]:
        """Return the codes of a category by element (`uq.result.elements.category_codes`)."""
        return elements.category_codes(self.dataset, name)

    def elements(self, outputs: Sequence[str], every: bool = False) -> Iterator[Element]:
        """Yield the elements of outputs (`uq.result.elements.elements_of`)."""
        return elements.elements_of(self.dataset, outputs, every)

    def named_elements(self, name: str) -> list[Element]:
        """Return the elements that a name refers to (`uq.result.elements.named_elements`)."""
        return elements.named_elements(self.dataset, name)

    def lifetimes(self, name: str) -> list[Element]:
        """Return the elements of a lifetime (`uq.result.elements.lifetimes`)."""
        return elements.lifetimes(self.dataset, name)

    @property
    def notes_on_places(self) -> list[str]:
        """A sentence on each output of which only some elements are shown."""
        return elements.notes_on_places(self.dataset)

    @cached_property
    def inputs(self) -> Floats:
        """The values of the uncertain inputs, shape (n, d)."""
        return elements.inputs_of(self.dataset)

    def input_unit(self, name: str) -> ReadableUnit:
        """Return the unit in which an input is read."""
        return variables.input_unit(self.dataset, name)

    # Rows: outcome, dependence and weights

    @cached_property
    def failed(self) -> Mask:
        """Mask of rows that failed, shape (n,)."""
        return result_file.failed(self.dataset)

    def refuse_empty(self) -> None:
        """Refuse a result without rows.

        Raises
        ------
        InputError
        """
        result_file.refuse_empty(self.dataset)

    @cached_property
    def independent(self) -> "Result":
        """The rows for plain statistics (`uq.result.elements.independent_rows`).

        Raises
        ------
        InputError
            When there are no rows at all.
        """
        rows = elements.independent_rows(self.dataset)
        return self if rows is self.dataset else Result(rows)

    @cached_property
    def why_no_statistics(self) -> str:
        """Why the rows do not support plain statistics (a predicate), or ""."""
        return elements.why_no_statistics(self.dataset)

    @cached_property
    def replicates(self) -> Replicates:
        """The replicate or cluster of each row (`uq.result.elements.replicates_of`)."""
        return elements.replicates_of(self.dataset)

    @property
    def has_independent_rows(self) -> bool:
        """Whether rows (blocks A and B of a crossed design) are independent."""
        return elements.are_independent(self.dataset)

    @property
    def has_independent_samples(self) -> bool:
        """Whether samples are independent, however many rows each has."""
        return elements.has_independent_samples(self.dataset)

    @property
    def has_weights(self) -> bool:
        """Whether inspections have weighted the rows."""
        return row_weights.has_weights(self.dataset)

    @property
    def has_rounds(self) -> bool:
        """Whether a sampler has added rows to those of the design."""
        return row_weights.has_rounds(self.dataset)

    @property
    def row_weights(self) -> Floats | None:
        """The weights of rows, of mean 1 (`uq.result.weights.row_weights`)."""
        return row_weights.row_weights(self.dataset)

    @cached_property
    def weights(self) -> Smoothed | None:
        """The weights of rows with their quality (`uq.result.elements.weights_of`)."""
        return elements.weights_of(self.dataset)

    def sample_weights(self, question: str) -> Floats | None:
        """Return the weights of samples whose units were not inspected (`sample_weights`)."""
        return row_weights.sample_weights(self.dataset, self.nesting, question)

    @property
    def stands_for_any_unit(self) -> bool:
        """Whether rows stand for any unit: no inspection concerns the units."""
        return row_weights.stand_for_any_unit(self.dataset)

    def refuse_weights(self, question: str) -> None:
        """Refuse a question that weighted rows cannot answer.

        Raises
        ------
        InputError
        """
        row_weights.refuse_weights(self.dataset, question)

    # Samples, units, repeats, and parts of the rows

    @cached_property
    def nesting(self) -> Nesting:
        """The places of rows in samples, units and repeats."""
        return nesting.nesting_of(self.dataset)

    @property
    def is_nested(self) -> bool:
        """Whether samples have several rows."""
        return nesting.is_nested(self.dataset)

    @property
    def levels(self) -> dict[str, str]:
        """The level of each input, by name."""
        return nesting.levels_of(self.dataset)

    def levels_that_vary(self, without: Collection[str] = ()) -> Sequence[str]:
        """Return the levels on which rows differ (`uq.result.nesting.levels_that_vary`)."""
        return nesting.levels_that_vary(self.dataset, without)

    @property
    def first_rows(self) -> "Result":
        """The first repeat of the first unit of each sample: they follow a plain design."""
        rows = nesting.one_of_each_sample(self.dataset)
        return self if rows is self.dataset else Result(rows)

    def first_samples(self, samples: int) -> "Result":
        """Return the rows of the first samples of each replicate."""
        return Result(nesting.first_samples(self.dataset, samples))

    @cached_property
    def ranked(self) -> "Result":
        """The rows that rank inputs (`uq.result.ranked_rows.ranked_rows`)."""
        rows = ranked_rows.ranked_rows(self.dataset)
        return self if rows is self.dataset else Result(rows)

    @property
    def ranked_in_words(self) -> str:
        """A phrase for the rows that are ranked, ``by the first 50 000 rows``; "" for all."""
        return ranked_rows.ranked_in_words(self.ranked.dataset, self.dataset)

    def within_regime(self, regime: str) -> "Result":
        """Return the rows in one regime (`uq.result.regimes.within_regime`)."""
        return Result(regimes.within_regime(self.dataset, regime))

    # Commands on the file

    @property
    def file(self) -> str:
        """The file as a shell reads it, OUT if it is not recorded."""
        return commands.file_of(self.dataset)

    @property
    def model_option(self) -> str:
        """``--model`` and a file, after a blank, for a model that is not installed here."""
        return commands.model_option(self.dataset)


AnyResult = Result | xr.Dataset | str | Path
"""What public functions take for a result."""
