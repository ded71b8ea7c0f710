"""Differences between two records."""

import difflib
import json
import re
from pathlib import Path
from typing import Any

_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")
_LINES = 40


def compare(first: Path, second: Path, only: str) -> int:
    """Print what differs, and return how many entries do.

    Entries whose numbers differ come first, then entries whose words or names differ, and last
    entries that one record lacks.
    """
    a, b = (json.loads(path.read_text()) for path in (first, second))
    keys = [key for key in {**a, **b} if re.search(only, key.partition(": ")[0])]
    absent = [key for key in keys if (key in a) != (key in b)]
    different = [key for key in keys if key not in absent and a[key] != b[key]]
    in_numbers = [key for key in different if numbers_in(a[key]) != numbers_in(b[key])]
    in_words = [key for key in different if key not in in_numbers]
    for kind, differing in (("numbers differ", in_numbers), ("words differ", in_words)):
        for key in differing:
            print(f"=== {key}: {kind}")
            before, after = (_text(side[key]).splitlines() for side in (a, b))
            lines = list(difflib.unified_diff(before, after, lineterm="", n=0))[2:]
            print(*lines[:_LINES], *(["..."] * (len(lines) > _LINES)), sep="\n")
    for key in absent:
        print(f"=== {key}: in {first if key in a else second} only")
    print(
        f"{len(keys)} entries: {len(in_numbers)} differ in numbers, {len(in_words)} in words only,"
        f" {len(absent)} are in one record only"
    )
    return len(different) + len(absent)


def numbers_in(entry: Any) -> list[str]:
    """Return the numbers of an entry, in order; those in texts, too."""
    return _NUMBER.findall(_text(entry))


def _text(entry: Any) -> str:
    return json.dumps(entry, indent=1, ensure_ascii=False).replace("\\n", "\n")
