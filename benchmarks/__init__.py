"""Speed and accuracy compared with common alternatives; run with ``python -m benchmarks.NAME``.

heyoka, a rival of some, is optional: install it to see its lines.
"""

import models.numerics.jit  # noqa: F401  (before numba: what it may compile for is read at import)
