"""What ``uq row`` shows."""

from pathlib import Path
from typing import Any

from uq.cli.printing import grid, heading, note, print_json
from uq.cli.progress import say_compiling
from uq.cli.simulate import as_json, check_files, draw, show_outputs
from uq.contract import Status
from uq.errors import InputError
from uq.execution.loading import load_model
from uq.explore.row_again import RowAgain, row_again
from uq.explore.simulation import with_trajectory
from uq.machines.compilation import compilation
from uq.result.result_file import open_result
from uq.study.installed_models import find_model
from uq.text.numbers import capitalized, quantity


def row(
    result: Path,
    number: int | None,
    lowest: str | None,
    near_quantile: tuple[float, str] | None,
    plot: Path | None,
    model: str | None,
    json: bool,
) -> int:
    """Show a row of a result, computed again; return the exit code."""
    ds = open_result(result)
    if plot:
        check_files(load_model(model) if model else find_model(ds.attrs["model"]), None, plot)
    with compilation(say_compiling):
        found = row_again(ds, number, lowest, near_quantile, model, str(result))
        if plot:
            if found.again is None:
                raise InputError(f"{result}: row {found.number}: no trajectory: {found.reason}")
            draw(with_trajectory(found.there, found.again), plot)
    print_json(plain(found)) if json else _show(found, ds.sizes["sample"])
    return 1 if found.differing else 0


def plain(found: RowAgain) -> dict[str, Any]:
    """Return a row as plain data, for JSON.

    Returns
    -------
    dict
        ``row``, ``equal``, ``place`` in the design, and the row as `uq simulate` prints it. Where
        it is not equal, ``reason``, and if it was computed again ``differing`` and ``again``. What
        differs here from what made the result is in ``versions``, ``[there, here]``.
    """
    again = found.again
    entry: dict[str, Any] = {"row": found.number, "equal": found.equal, "place": found.place}
    entry |= {"chosen": found.choice.words} if found.choice else {}
    entry |= {"seed": again.seed} if again else {}
    entry |= as_json(found.row)
    if found.reason:
        entry["reason"] = found.reason
    if again and found.differing:
        here = as_json(again)
        entry["differing"] = list(found.differing)
        entry["again"] = {name: here[name] for name in ("inputs", "outputs", "status")}
    if found.versions:
        entry["versions"] = {name: list(pair) for name, pair in found.versions.items()}
    return entry


def _show(found: RowAgain, rows: int) -> None:
    one, (status, meaning) = found.row, found.row.ending
    title = f"{one.model.name}, row {found.number} of {rows}: {status.label}"
    heading(title, "" if status is Status.OK else meaning)
    if found.choice:
        grid([(found.choice.words,)])
    grid([(", ".join(f"{name} {place}" for name, place in found.place.items()),)])
    heading("\ninputs")
    grid(
        [
            (name, quantity(value, unit))
            for name, value in one.values.items()
            if found.there[name].attrs.get("role") == "input"
            for unit in [found.there[name].attrs["units"]]
        ]
    )
    show_outputs(one)
    note(_in_words(found))


def _in_words(found: RowAgain) -> str:
    if found.again is None:
        return f"{capitalized(found.reason)}."
    code = "; the code of the model has changed since" if "code" in found.versions else ""
    if found.equal:
        return f"Computed again: equal to the bit{code}."
    return f"Computed again: differs in {', '.join(found.differing)}. Reason: {found.reason}."
