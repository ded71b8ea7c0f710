"""A model on a UM-Bridge server as a machine: each row is a separate call."""

import hashlib
import json
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from itertools import count, islice
from math import inf, nan
from typing import Any

from uq.contract import Model, Parameter, censored_name
from uq.errors import InputError
from uq.machines.returned import Censored, Returned, from_plain
from uq.machines.row_by_row import SEED, RowByRow, model_from
from uq.machines.um_bridge import DESCRIBED, NEVER, VERSION, ServerError, call, split_address

_SOON = 5.0  # seconds for which a server is expected to start
_LARGEST = 10_000_000  # numbers in an answer

_ZEROS = "the server states no nominal values, so all inputs are 0: give others, --set x1=1"

_turns = count(os.getpid())  # of several servers, each process begins with another one


@dataclass(frozen=True)
class _RemoteModel:
    """A model as described by its servers; calling it with a row requests the outputs."""

    servers: tuple[str, ...]
    name: str
    inputs: tuple[int, ...]
    outputs: tuple[int, ...]
    information: Mapping[str, Any]
    row_limit: float = inf  # time for a row [s]

    @property
    def described(self) -> Mapping[str, Any]:
        """Names, units and bounds, if its server states them as `uq.machines.serving` does."""
        return self.information.get(DESCRIBED) or {}

    def __call__(self, **row: float | int) -> dict[str, Any]:
        """Return the outputs of a row.

        Raises
        ------
        ServerError, RowError
        """
        config = {SEED: row[SEED]} if SEED in row else {}
        inputs = iter(map(float, row.values()))
        vectors = [list(islice(inputs, size)) for size in self.inputs]
        body = {"name": self.name, "input": vectors, "config": config}
        turn = next(_turns) % len(self.servers)
        servers = self.servers[turn:] + self.servers[:turn]
        try:
            answer = call(servers, "Evaluate", body, limit=self.row_limit)
        except ServerError as error:
            if self.described or any(map(any, vectors)):
                raise
            raise ServerError(f"{error}; {_ZEROS}") from None
        output = answer.get("output") if isinstance(answer, dict) else None
        if not isinstance(output, list) or not all(isinstance(vector, list) for vector in output):
            raise ServerError(f"{self.servers[0]} answers Evaluate without a list of vectors")
        if self.described:
            return self._named(_numbers(output, answer.get(NEVER)))
        names = _vectors(len(output))
        return {n: v[0] if len(v) == 1 else v for n, v in zip(names, output, strict=True)}

    def _named(self, output: list[list[float]]) -> dict[str, Any]:
        """Return outputs of a server that describes them: vectors by name, then flags."""
        columns = dict(zip(self.described["columns"], output, strict=True))
        outputs: dict[str, Any] = {}
        for name, entry in self.described["outputs"].items():
            flags = columns.get(censored_name(name)) or [0.0] * len(columns[name])
            both = zip(columns[name], flags, strict=True)
            values = [Censored(value) if cut else value for value, cut in both]
            outputs[name] = values if entry["shape"] else values[0]
        return outputs


def server_model(address: str) -> Model:
    """Return the model at an address.

    Parameters
    ----------
    address : str
        ``http://HOST:PORT/NAME``, or several with commas between them: of the same model.

    Returns
    -------
    Model
        Its parameters are x1, x2, ... (x1_1, ... of several vectors) and its outputs y, or y1, ...
        of several vectors, unless the server describes them, as `uq.machines.serving` does.

    Raises
    ------
    InputError
        When no such model is there.
    """
    first, *others = address.split(",")
    remote = _remote_model(first)
    for other in others:
        copy = _remote_model(other)
        if replace(copy, servers=remote.servers) != remote:
            raise InputError(f"{other}: is a different model than {first}")
        remote = replace(remote, servers=remote.servers + copy.servers)
    described = remote.described
    try:
        fields = {
            entry["name"]: (
                Parameter(
                    entry["name"],
                    entry["unit"],
                    entry["meaning"],
                    _bounds(*entry["bounds"]),
                    "assumed: of the server",
                ),
                float(entry["nominal"]),
            )
            for entry in described.get("parameters", ())
        } or {
            name: (Parameter(name, "1", name, (-inf, inf), "assumed: none is stated"), 0.0)
            for name in _names(remote.inputs)
        }
        outputs = from_plain(described.get("outputs", {})) or {
            name: Returned(shape=() if size == 1 else (size,))
            for name, size in zip(_vectors(len(remote.outputs)), remote.outputs, strict=True)
        }
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise InputError(f"{address}: describes itself wrongly: {error!r}") from None
    name = re.sub(r"[^A-Za-z0-9_-]", "-", remote.name)
    random = bool(described.get("random"))
    batch = RowByRow(remote, tuple(fields), outputs, random)
    title = f"{remote.name} on a UM-Bridge server"
    return model_from(name, title, f"UM-Bridge {VERSION:g}", fields, outputs, batch, random)


def code_of_server(address: str) -> str:
    """Return a hash of the description of a model by its server, as its code is not accessible."""
    remote = _remote_model(address.partition(",")[0])
    sizes = remote.inputs, remote.outputs
    text = json.dumps([remote.name, VERSION, *sizes, remote.information], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@cache
def _remote_model(address: str) -> _RemoteModel:
    server, name = split_address(address)
    try:
        information = call(server, "Info", patience=_SOON)
        models = list(map(str, information["models"]))
        if information["protocolVersion"] != VERSION:
            raise InputError(
                f"{address}: speaks version {information['protocolVersion']} of UM-Bridge, not"
                f" {VERSION:g}"
            )
        if name not in models:
            raise InputError(f"{address}: no such model (there: {', '.join(models)})")
        body = {"name": name, "config": {}}
        sizes = tuple(int(n) for n in call(server, "InputSizes", body)["inputSizes"])
        outputs = tuple(int(n) for n in call(server, "OutputSizes", body)["outputSizes"])
        about = call(server, "ModelInfo", body)
        if not about["support"].get("Evaluate"):
            raise InputError(f"{address}: this model cannot be evaluated")
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{address}: is no UM-Bridge server: {error!r}") from None
    except ServerError as error:
        raise InputError(f"{address}: {error}") from None
    if not 0 < sum(sizes) <= 10_000:
        raise InputError(f"{address}: has {sum(sizes)} inputs")
    if not 0 < sum(outputs) <= _LARGEST or min(outputs) < 1:
        raise InputError(f"{address}: has outputs of sizes {outputs}")
    return _RemoteModel((server,), name, sizes, outputs, about)


def _vectors(count: int) -> list[str]:
    """Return the names of output vectors of a server that does not describe itself."""
    return ["y"] if count == 1 else [f"y{i + 1}" for i in range(count)]


def _names(sizes: tuple[int, ...]) -> list[str]:
    if len(sizes) == 1:
        return [f"x{i + 1}" for i in range(sizes[0])]
    return [f"x{v + 1}_{i + 1}" for v, size in enumerate(sizes) for i in range(size)]


def _bounds(low: float | None, high: float | None) -> tuple[float, float]:
    """Return bounds; JSON has null for an infinite one."""
    return -inf if low is None else float(low), inf if high is None else float(high)


def _numbers(output: list[list[float | None]], never: Any) -> list[list[float]]:
    """Return vectors with null replaced by infinity for lives that never end, else by NaN."""
    places: Any = never if isinstance(never, list) else [()] * len(output)
    return [
        [(inf if i in at else nan) if value is None else value for i, value in enumerate(vector)]
        for vector, at in zip(output, map(set, places), strict=True)
    ]
