"""Speed and accuracy beside what one would use instead; run with ``python -m benchmarks.NAME``."""
