"""Count how often each reported interval contains the truth, and write docs/coverage.md.

``python -m benchmarks.coverage [PART ...]``: without a name, every part that is not yet counted;
with names, these again. Each part is kept in results/coverage.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "TBB_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

from benchmarks.coverage.page import page, shown  # noqa: E402
from benchmarks.coverage.parts import PARTS  # noqa: E402
from benchmarks.coverage.tally import Line  # noqa: E402

KEPT = Path("results/coverage")
PAGE = Path("docs/coverage.md")


def main():
    """Count, print, write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage")
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--repetitions", type=int, help="of each part (default: its own)")
    asked = parser.parse_args()
    if unknown := set(asked.parts) - set(PARTS):
        parser.error(f"no such part: {', '.join(sorted(unknown))}")
    for name in asked.parts or [name for name in PARTS if not _file(name).exists()]:
        part = PARTS[name]
        began = time.process_time()
        lines = part.count(asked.repetitions or part.repetitions)
        seconds = time.process_time() - began
        print(f"{name}: {seconds:.1f} s")
        for line in lines:
            print("   ", shown(line))
        KEPT.mkdir(parents=True, exist_ok=True)
        kept = {"seconds": seconds, "lines": [line._asdict() for line in lines]}
        _file(name).write_text(json.dumps(kept, indent=1))
    done = [name for name in PARTS if _file(name).exists()]
    counted = [json.loads(_file(name).read_text()) for name in done]
    lines = [Line(**line) for record in counted for line in record["lines"]]
    missing = [name for name in PARTS if name not in done]
    PAGE.write_text(page(lines, sum(record["seconds"] for record in counted), missing))
    print(f"written: {PAGE}")
    off = [shown(line) for line in lines if line.unexplained]
    if off:
        return "\n".join(["off, and nothing says why:", *off])
    return f"not yet counted: {', '.join(missing)}" if missing else 0


def _file(name):
    return KEPT / f"{name}.json"


if __name__ == "__main__":
    sys.exit(main())
