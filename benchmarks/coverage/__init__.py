"""How often each reported interval contains the truth: ``python -m benchmarks.coverage``."""
