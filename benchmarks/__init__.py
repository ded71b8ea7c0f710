"""Speed and accuracy beside what one would use instead; run with ``python -m benchmarks.NAME``.

heyoka, beside which the vibrator runs, is optional: install it to see its lines.
"""

import models.numerics.jit  # noqa: F401  (before numba: what it may compile for is read at import)
