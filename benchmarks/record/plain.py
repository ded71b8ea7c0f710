"""Texts and JSON without what depends on the computer, the place and the time."""

import base64
import hashlib
import json
import re
from typing import Any

_REPLACED = (
    (r"\buq\.(?:[a-z_0-9]+\.)+(?=\w)", ""),  # packages and modules of a function
    (r"/tmp/\S*/", ""),
    (r"(\d rows? computed) in [\d.]+ \w+", r"\1"),
    (r"(?m)^(code +)[0-9a-f]{16,}.*$", r"\1..."),
    (r'("code": )"[0-9a-f]{16,}"', r'\1"..."'),
    (r"; the code of the model has changed since", ""),
    (r'"code": \[\s*"[0-9a-f]+",\s*"[0-9a-f]+"\s*\]', '"code": ["...", "..."]'),
)
_ENCODED = re.compile(r"[A-Za-z0-9+/]{60,}={0,2}")


def plain(text: str) -> str:
    """Return text without names of modules and folders, and without hashes of code."""
    for pattern, replacement in _REPLACED:
        text = re.sub(pattern, replacement, text)
    return text


def outcome_of(outcome: dict[str, object]) -> dict[str, object]:
    """Return the outcome of a command, with JSON parsed."""
    out, err = plain(str(outcome["out"])), plain(str(outcome["err"]))
    if out.startswith(("{", "[")):
        out = json.loads(out)
    return {"code": outcome["code"], "out": out, "err": err}


def digest(values: bytes) -> str:
    """Return a hash of bits."""
    return hashlib.sha256(values).hexdigest()[:16]


def embedded(text: str) -> Any:
    """Return the data blocks inside a page, arrays of bytes by their hashes."""
    blocks = re.findall(r'<script type="application/json"[^>]*>(.*?)</script>', text, re.DOTALL)
    return [_hashed(json.loads(block)) for block in blocks]


def _hashed(entry: Any) -> Any:
    if isinstance(entry, dict):
        return {name: _hashed(value) for name, value in entry.items()}
    if isinstance(entry, list):
        return [_hashed(value) for value in entry]
    if isinstance(entry, str) and _ENCODED.fullmatch(entry):
        return digest(base64.b64decode(entry))
    return entry


def words_of(text: str) -> str:
    """Return a page without its scripts, styles and pictures."""
    text = re.sub(r"<(script|style)\b.*?</\1>", "", text, flags=re.DOTALL)
    return plain(re.sub(r"base64,[^\"')]*", "base64,...", text))
