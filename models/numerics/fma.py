"""Fused multiply-add, only where the source requests it.

Vectorised algebra runs up to 1.7 times as fast with it. Letting the compiler fuse at will
(``contract``) is as fast, but then the last bits depend on what it inlines where. Written out, they
are a function of source and inputs. A processor without the instruction calls the C library
instead: the same bits, but slow.
"""

import math
from typing import Any

import numba
from numba.core import types
from numba.extending import intrinsic


def exact_fma(a: float, b: float, c: float) -> float:
    """Return a b + c, rounded once; this is `fma` when compilation is disabled.

    Parameters
    ----------
    a, b, c : float

    Returns
    -------
    float
        As in IEEE 754, including signed zeros, infinities and NaN.
    """
    a, b, c = float(a), float(b), float(c)
    if not (math.isfinite(a) and math.isfinite(b)):
        return a * b + c
    if not math.isfinite(c):
        return c
    top_a, bottom_a = a.as_integer_ratio()
    top_b, bottom_b = b.as_integer_ratio()
    top_c, bottom_c = c.as_integer_ratio()
    bottom = bottom_a * bottom_b
    top = top_a * top_b * bottom_c + top_c * bottom
    if top == 0:
        return a * b + c  # exact, with the correct sign
    try:
        return top / (bottom * bottom_c)
    except OverflowError:
        return math.inf if top > 0 else -math.inf


@intrinsic
def _instruction(typingctx: Any, a: Any, b: Any, c: Any) -> Any:
    """Emit the processor's fused multiply-add, for arguments of any type."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kinds = signature.args
        floats = [
            context.cast(builder, value, kind, types.float64)
            for value, kind in zip(values, kinds, strict=True)
        ]
        return builder.fma(*floats)

    return types.float64(a, b, c), generate


_config: Any = numba.config
fma: Any = exact_fma if _config.DISABLE_JIT else _instruction
"""``fma(a, b, c)`` is a b + c with one rounding, in kernels."""
