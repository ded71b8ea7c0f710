"""Study: a validated study file with its model, and the comparison of two studies."""

import hashlib
import json
import re
import shlex
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import Any, Self

from uq.contract import Model
from uq.errors import InputError, nearest_file
from uq.files.netcdf_files import SIGNATURES
from uq.sampling.data_files import (
    columns_of_files,
    numbers,
    with_columns,
    with_rows_of_files,
)
from uq.sampling.designs import DESIGNS, IMPORTED
from uq.sampling.input_faults import InputFault
from uq.sampling.law import Law
from uq.sampling.named_values import read_settings
from uq.study.changes import change, study_text
from uq.study.checks import design_faults, model_faults, number_of_fixed
from uq.study.file import (
    NAME,
    AnalysisTable,
    DependenceTable,
    DesignTable,
    StudyFile,
    Tied,
)
from uq.study.input_checks import dependence_faults, import_faults, input_faults, read_entries
from uq.study.installed_models import SUFFIX, find_model, model_at
from uq.study.reading import in_units_of, parse, shape_faults, sound_entries, with_numbers
from uq.text.literals import read_toml, shown
from uq.text.numbers import counted

_LONGEST = 1_000_000  # bytes of a study file


@dataclass(frozen=True)
class Study:
    """A validated study: model, inputs, design and analysis, independent of where it runs.

    Attributes
    ----------
    name : str
    model : Model
    model_reference : str
        Reference with which `uq.study.installed_models.model_at` finds the model in any process.
    description : str
    design : DesignTable
        method, samples, replicates, units, repeats, second_order, seed, until.
    fixed : dict of str to float
        Parameters that override their nominal values; `source_of_fixed` has their sources.
    uncertain : dict of str to Law
        Laws in the order of the file, which is the order of the columns of the design. For a
        parameter that is a multiple of another, the law of the factor.
    settings : object
        An instance of ``model.settings``.
    analysis : AnalysisTable
        outputs (all of them if the file names none), quantiles, max_failed, tolerance,
        thresholds, twin, sensitivity.
    text : str
        Complete study file, with the contents of the files that it names.
    path : str
        Path from which the file was read.
    tied : dict of str to Tied
        Parameters that equal another parameter.
    dependence : DependenceTable or None
    imported : dict of str to str
        For an imported design: parameter -> its column, for `uq.sampling.data_files.numbers`.
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
    tied: Mapping[str, Tied] = field(default_factory=dict)
    dependence: DependenceTable | None = None
    imported: Mapping[str, str] = field(default_factory=dict)

    def bounds(self, name: str) -> tuple[float, float]:
        """Return the intersection of the bounds of a parameter and of the parameters tied to it."""
        names = [name, *(other for other, tied in self.tied.items() if tied.equals == name)]
        lows, highs = zip(
            *(self.model.parameter(parameter).bounds for parameter in names), strict=True
        )
        return max(lows), min(highs)

    @property
    def levels(self) -> tuple[str, ...]:
        """The level of each uncertain parameter, in order; see `uq.sampling.levels`."""
        return tuple(law.level for law in self.uncertain.values())

    def level(self, name: str) -> str:
        """Return the level of a varying parameter; tied parameters have the same level."""
        law = self.uncertain[self.tied[name].equals if name in self.tied else name]
        return law.level

    @property
    def random(self) -> bool:
        """Whether rows depend on their seed."""
        free = {*self.uncertain, *self.tied}
        return self.model.random and not any(
            name not in free and self.fixed.get(name, self.model.nominal[name]) == value
            for name, value in self.model.random_unless.items()
        )

    @property
    def identity(self) -> str:
        """SHA-256 of all inputs of the rows, without their number, comments and [analysis]."""
        without = {"samples", "file", "until", "independent", "units", "repeats"}
        design = self.design.model_dump(exclude=without)
        constants = {
            name: self.fixed.get(name, nominal)
            for name, nominal in self.model.nominal.items()
            if name not in self.uncertain and name not in self.tied
        }
        # Contents of files are included, their names are not.
        laws = [
            [name, law.model_dump(exclude={"source", "file", "column", "level"}, exclude_none=True)]
            for name, law in self.uncertain.items()
        ]
        parts = [self.model.name, self.model.version, design, constants, laws]
        parts.append(self.model.choices_of(self.settings))
        # Added only if present, so that studies without them keep their identity.
        if self.tied:
            parts.append({name: tied.equals for name, tied in self.tied.items()})
        if self.dependence:
            given = self.dependence.model_dump(exclude={"source"}, exclude_defaults=True)
            parts.append(given)
        if self.imported:
            parts.append(dict(self.imported))
        if self.design.rows_of_a_sample > 1:  # otherwise levels have no effect
            sizes = [self.design.units, self.design.repeats]
            parts.append({"rows of a sample": sizes, "levels": self.levels})
        if self.random and DESIGNS[self.design.method].shares_seeds:
            parts.append("rows that are compared share a seed")
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()

    def with_samples(self, samples: int) -> Self:
        """Return the study with another number of samples.

        Parameters
        ----------
        samples : int
            Number of samples of each replicate.

        Returns
        -------
        Study

        Raises
        ------
        InputError
            The design cannot have this size.
        """
        problem = DESIGNS[self.design.method].size_problem(samples)
        for column in self.imported.values():
            if samples > (most := len(numbers(column))):
                problem = f"the file has {counted(most, 'row')}"
        if problem:
            raise InputError(f"samples = {samples}: {problem} for '{self.design.method}'")
        return replace(self, design=self.design.model_copy(update={"samples": samples}))

    def with_changes(self, changes: Mapping[str, Any]) -> "Study":
        """Return the study with some entries changed, checked as a file would be.

        Parameters
        ----------
        changes : dict of str to object
            Entries of the study file -> their values, as for `uq.what_if`: ``"design.samples"``,
            ``"settings.depths"``, ``"uncertain.initial_gap.sd"``. A mapping replaces a table. For
            another law, ``"uncertain.initial_gap": {"distribution": "normal", "mean": 2e-4,
            "sd": 1e-5}`` keeps `times`, `level` and `source` of the input unless it states its
            own. None removes an entry.

        Returns
        -------
        Study
            Its text is the changed file, without comments. Change ``"study.name"``, too, or choose
            another output when it runs: a result belongs to one study.

        Raises
        ------
        InputError
            One line per mistake, with the nearest name.

        Examples
        --------
        >>> study = uq.load_study("studies/exponential-wear.toml")
        >>> wider = study.with_changes({"study.name": "wider", "uncertain.rate.sigma": 0.8})
        >>> wider.uncertain["rate"].sigma, study.uncertain["rate"].sigma
        (0.8, 0.5)
        """
        data = read_toml(self.text)
        same = self.model_reference == data["study"]["model"] or "study.model" in changes
        data["design"]["samples"] = self.design.samples
        for place, value in changes.items():
            change(data, place, value, self.path)
        model = None if same else self.model_reference
        return study_from_text(study_text(data), self.path, model, Path(self.path).parent)


def load_study(path: str | PathLike[str], model: str | None = None) -> Study:
    """Return the validated study in a file, without running models that declare no outputs."""
    machine = re.fullmatch(r"(.+\.(?:py|fmu))(?::\w+)?", str(path))
    if machine and Path(machine[1]).is_file():
        raise _is_machine(str(path))
    if str(path).endswith(".csv") and Path(path).is_file():
        named = shlex.quote(str(path))
        reads = f"'uq import {named} -o OUT.nc --life COLUMN' reads lives from it"
        raise InputError(f"{path}: is a table, not a study; {reads}")
    return study_from_text(_read(Path(path)), str(path), model, Path(path).parent)


def study_from_text(
    text: str, source: str = "study", model: str | None = None, folder: Path | None = None
) -> Study:
    """Return the validated study from the text of a study file; see `load_study`.

    Parameters
    ----------
    text : str
        Complete TOML text.
    source : str
        Name of the text in error lines.
    model : str, optional
    folder : Path, optional
        Base folder of relative file names; not required for the text in a result.

    Returns
    -------
    Study

    Raises
    ------
    InputError
    """
    data = parse(text, source)
    if "machine" in data and "study" not in data:
        raise _is_machine(source)
    lines: list[str] = []
    reference = model or _model_named(data)
    study_model, misfits, of_model = None, dict[tuple[str, ...], str](), list[InputFault]()
    if reference is not None:
        try:
            study_model = find_model(reference, folder) if model is None else model_at(model)
        except InputError as error:
            if model is not None:
                lines += error.lines
            else:
                of_model = [InputFault(("study", "model"), line, reference) for line in error.lines]
    if study_model is not None:
        if model and model.endswith(SUFFIX) and _leave_out(data, study_model):
            text = study_text(data)
        misfits = in_units_of(study_model, data)
        text = with_numbers(text, data)
    faults = [
        fault._replace(problem=misfits.get(tuple(map(str, fault.path)), fault.problem))
        for fault in shape_faults(data)
    ]
    tables = sound_entries(data, faults)
    columns, more = columns_of_files(tables, folder)
    tables["settings"] = with_rows_of_files(tables["settings"], columns)
    entries, spoilt = read_entries(tables, columns)
    incomplete = any(fault.path[0] == "dependence" for fault in faults)
    faults += [*more, *spoilt, *dependence_faults(tables, entries, incomplete), *of_model]
    if study_model is not None:
        faults += model_faults(study_model, data, tables)
        faults += input_faults(study_model, entries)
        faults += import_faults(study_model, tables, entries, columns)
    faults += design_faults(tables)
    order = (*StudyFile.model_fields, *data)
    faults.sort(key=lambda fault: order.index(str(fault.path[0])))
    lines += [f"{source}: {fault.line}" for fault in faults]
    if lines or study_model is None or reference is None:
        raise InputError(*lines)

    file = StudyFile.model_validate(data)
    settings, _ = read_settings(study_model, tables["settings"])
    constants = study_model.nominal | dict(file.fixed)
    for name in entries:
        constants.pop(name, None)
    if why := study_model.refusal(settings, constants):
        raise InputError(f"{source}: {why}")
    study_model = study_model.given(settings, constants)
    file = file.in_units({name: output.unit for name, output in study_model.outputs.items()})
    outputs = file.analysis.outputs or tuple(study_model.outputs)
    uncertain = {name: law for name, law in entries.items() if not isinstance(law, Tied)}
    table = columns[file.design.file] if file.design.file and file.design.method in IMPORTED else {}
    imported = {name: table[name] for name in uncertain if table}
    rows = min((len(numbers(column)) for column in imported.values()), default=0)
    return Study(
        name=file.study.name,
        model=study_model,
        model_reference=reference,
        description=file.study.description,
        design=file.design.model_copy(update={"samples": file.design.samples or rows}),
        fixed=file.fixed,
        uncertain=uncertain,
        settings=settings,
        analysis=file.analysis.model_copy(update={"outputs": outputs}),
        text=with_columns(text, columns, file.data),
        path=source,
        tied={name: tied for name, tied in entries.items() if isinstance(tied, Tied)},
        dependence=file.dependence,
        imported=imported,
    )


def _leave_out(data: dict[str, Any], emulated: Model) -> bool:
    """Leave out the entries of [analysis] on outputs without an emulator; return if there are any.

    The twin of the emulated model goes, too: no emulator computes one alone.
    """
    analysis, refused = data.get("analysis"), emulated.batch.emulator.refused  # type: ignore[attr-defined]
    if not isinstance(analysis, dict):
        return False
    before = json.dumps(analysis, default=str)
    analysis.pop("twin", None)
    for key in ("outputs", "thresholds", "joint_bounds"):
        match analysis.get(key):
            case list() as names:
                analysis[key] = [name for name in names if name not in refused]
            case dict() as entries:
                analysis[key] = {k: v for k, v in entries.items() if k not in refused}
    return json.dumps(analysis, default=str) != before


def _model_named(data: Mapping[str, Any]) -> str | None:
    """Return the model that a parsed file names; None if it names none."""
    study = data.get("study")
    named = study.get("model") if isinstance(study, dict) else None
    return named if isinstance(named, str) and re.fullmatch(NAME, named) else None


def _is_machine(source: str) -> InputError:
    named = shlex.quote(source)
    return InputError(
        f"{source}: is a machine, not a study; 'uq init {named} > study.toml' writes a study of it,"
        f" and 'uq run study.toml --model {named}' runs it"
    )


def _read(path: Path) -> str:
    try:
        with path.open("rb") as file:
            content = file.read(_LONGEST + 1)
        if content.startswith(SIGNATURES):
            named = shlex.quote(str(path))
            raise InputError(
                f"{path}: is a netCDF file, not a study; of a result, 'uq summary {named}' shows"
                f" the answer, and 'uq extend {named} --samples N' adds rows"
            )
        if len(content) > _LONGEST:
            raise InputError(f"{path}: a study is at most {_LONGEST // 1_000_000} MB long")
        return content.decode("utf-8-sig")
    except FileNotFoundError:
        folder = path.parent
        files = [*folder.glob("studies/*.toml"), *folder.glob("*.toml")]
        names = [str(file.relative_to(folder)) for file in files]
        begin = f"; 'uq init MODEL > {path.name}' writes one to edit"
        remedy = nearest_file(path.name, names) or begin
        raise InputError(f"{path}: no such file{remedy}") from None
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


_FREE = {("study", "name"), ("study", "description"), ("design", "samples"), ("design", "until")}
"""Entries that do not affect the rows."""


def what_changed(text: str, model_version: str, study: Study) -> str:
    """Return the first difference between a study and the study of the computed rows.

    Parameters
    ----------
    text : str
        Study file of the computed rows.
    model_version : str
        Version of the model that computed them.
    study : Study
        Study with another identity.

    Returns
    -------
    str
        The first difference, such as ``[design] seed = 5, now 6``.
    """
    try:
        before = dict(_entries(read_toml(text)))
    except (ValueError, OverflowError, RecursionError):
        before = {}
    now = dict(_entries(read_toml(study.text)))
    if study.design.rows_of_a_sample == 1:  # levels have no effect
        before, now = (
            {place: value for place, value in entries.items() if place[2:] != ("level",)}
            for entries in (before, now)
        )
    for place in before | now:
        if before.get(place) != now.get(place):
            *tables, name = place
            entry = f"[{'.'.join(tables)}] {name}"
            if place not in before:
                return f"{entry} = {shown(now[place])}, not given before"
            if place not in now:
                return f"{entry} = {shown(before[place])}, no longer given"
            return f"{entry} = {shown(before[place])}, now {shown(now[place])}"
    if model_version != study.model.version:
        return f"version {model_version} of model '{study.model.name}', now {study.model.version}"
    if list(before) != list(now):
        return "the order of [uncertain]"
    return f"the nominal values or default settings of model '{study.model.name}'"


def refusal_to_extend(study: Study) -> str | None:
    """Return the reason why samples cannot be appended to a study; None if they can."""
    method = study.design.method
    if DESIGNS[method].append_only:
        return None
    return (
        f"a '{method}' design cannot be extended: all its rows change with their number; run it "
        "again, into another output or with --fresh"
    )


def _entries(table: dict[str, Any], path: tuple[str, ...] = ()) -> Iterator[tuple[Any, Any]]:
    """Yield path and value of every entry that affects the rows."""
    for name, value in table.items():
        place = (*path, name)
        if (
            place[0] == "analysis"
            or place[:2] in _FREE
            or (path[:1] == ("uncertain",) and name == "source")
        ):
            continue
        if path == ("fixed",):
            yield place, number_of_fixed(value)
        elif isinstance(value, dict) and len(path) < 2:
            yield from _entries(value, place)
        else:
            yield place, value
