"""A study: a study file bound to its model, checked and frozen."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any, Self

from uq.checks import design_faults, model_faults
from uq.contract import Model
from uq.designs import DESIGNS
from uq.distributions import Law
from uq.errors import InputError, nearest
from uq.faults import Fault
from uq.reading import parse, read_study_text, shape_faults, sound_entries
from uq.registry import find_model
from uq.study_file import AnalysisTable, DesignTable, StudyFile
from uq.values import read_settings

__all__ = ["Study", "load_study", "read_study_text", "study_from_text"]


@dataclass(frozen=True)
class Study:
    """Everything a run needs to know, and nothing that depends on where it runs.

    Attributes
    ----------
    name : str
    model : Model
    model_reference : str
        What `uq.registry.find_model` finds the model by, in another process too.
    description : str
    design : DesignTable
        method, samples, replicates, second_order, seed, until.
    fixed : dict of str to float
        Parameters that override their nominal values.
    uncertain : dict of str to Law
        In the file's order, which is the order of the design's columns.
    settings : object
        An instance of ``model.settings``.
    analysis : AnalysisTable
        outputs (all of them if the file names none), quantiles, max_failed, tolerance,
        thresholds, twin, sensitivity.
    text : str
        The whole study file.
    path : str
        Where it was read from.
    """

    name: str
    model: Model
    model_reference: str
    description: str
    design: DesignTable
    fixed: Mapping[str, float]
    uncertain: Mapping[str, Law]
    settings: Any
    analysis: AnalysisTable
    text: str
    path: str

    @property
    def identity(self) -> str:
        """SHA-256 of what decides the rows: not how many, comments or [analysis]."""
        design = self.design.model_dump(exclude={"samples", "until"})
        constants = {
            name: self.fixed.get(name, nominal)
            for name, nominal in self.model.nominal.items()
            if name not in self.uncertain
        }
        laws = [
            [name, law.model_dump(exclude={"source"}, exclude_none=True)]
            for name, law in self.uncertain.items()
        ]
        parts = [
            self.model.name,
            self.model.version,
            design,
            constants,
            laws,
            asdict(self.settings),
        ]
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()

    def with_samples(self, samples: int) -> Self:
        """Return the same study with another number of samples.

        Parameters
        ----------
        samples : int
            Base size of each replicate.

        Returns
        -------
        Study

        Raises
        ------
        InputError
            The design cannot have this size; the line names ``--samples``.
        """
        problem = DESIGNS[self.design.method].size_problem(samples)
        if problem:
            raise InputError(f"--samples {samples}: {problem} for '{self.design.method}'")
        return replace(self, design=self.design.model_copy(update={"samples": samples}))


def load_study(path: str | PathLike[str], model: str | None = None) -> Study:
    """Read and check a study file.

    Parameters
    ----------
    path : path-like
        A TOML file.
    model : str, optional
        Use this model (``"package.module:ATTRIBUTE"`` or an installed name) in place of the
        file's.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        Everything that is wrong with the file, one line each.
    """
    return study_from_text(_read(Path(path)), str(path), model)


def study_from_text(text: str, source: str = "study", model: str | None = None) -> Study:
    """Check the text of a study file; see `load_study`.

    Parameters
    ----------
    text : str
        The whole TOML.
    source : str
        Where it comes from: what error lines call it.
    model : str, optional

    Returns
    -------
    Study

    Raises
    ------
    InputError
    """
    data = parse(text, source)
    faults = shape_faults(data)
    tables = sound_entries(data, faults)
    lines: list[str] = []

    reference = model or tables["study"].get("model")
    found = None
    if reference is not None:
        try:
            found = find_model(reference)
        except InputError as error:
            if model is not None:
                lines += error.lines
            else:
                faults += [Fault(("study", "model"), line, reference) for line in error.lines]
    if found is not None:
        faults += model_faults(found, data, tables)
    faults += design_faults(tables)
    order = (*StudyFile.model_fields, *data)
    faults.sort(key=lambda fault: order.index(str(fault.path[0])))
    lines += [f"{source}: {fault.line}" for fault in faults]
    if lines or found is None or reference is None:
        raise InputError(*lines)

    file = StudyFile.model_validate(data)
    settings, _ = read_settings(found, file.settings)
    outputs = file.analysis.outputs or tuple(found.outputs)
    return Study(
        name=file.study.name,
        model=found,
        model_reference=reference,
        description=file.study.description,
        design=file.design,
        fixed=file.fixed,
        uncertain=file.uncertain,
        settings=settings,
        analysis=file.analysis.model_copy(update={"outputs": outputs}),
        text=text,
        path=source,
    )


def _read(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        folder = path.parent
        files = [entry.name for entry in folder.glob("*.toml")] if folder.is_dir() else []
        raise InputError(f"{path}: no such file{nearest(path.name, files)}") from None
    except IsADirectoryError:
        raise InputError(f"{path}: is a directory; a study is a TOML file") from None
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: not a text file in UTF-8 (byte {error.start} is"
            f" 0x{error.object[error.start]:02x})"
        ) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{path}: cannot be read: {reason}") from None
