"""Power series of many systems at a time: the sums of Taylor's method.

A series is stored as its coefficients, each for all lanes, which are next to each other. The number
of terms is known when a sum is computed, not when it is compiled: a short loop over vectors of all
lanes serves every order.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numba
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from models.numerics.fma import exact_fma

_WIDE = 8
"""Lanes whose two sums are formed side by side: with more, registers of 256 bits do not suffice."""


class Sums(NamedTuple):
    """Sums over series, for kernels; all arguments but w are places in w, or counts.

    Attributes
    ----------
    products : callable
        ``products(w, terms, a, b, in_b, c, in_c)`` sets w[in_b] to the sum over j < terms of
        a_j b_(-j), and w[in_c] to that of a_j c_(-j): coefficients of the products of one series
        with two, of which b and c are the last coefficients that take part.
    value : callable
        ``value(w, terms, a, at, out)`` sets w[out] to the value of a series at w[at].
    value_and_slope : callable
        ``value_and_slope(w, terms, a, at, out, slope)`` sets its derivative, too.
    """

    products: Callable[..., None]
    value: Callable[..., None]
    value_and_slope: Callable[..., None]


def _plain(lanes: int) -> Sums:
    """Return the sums as they are computed when compilation is disabled."""

    def products(w, terms, a, b, in_b, c, in_c):
        for lane in range(lanes):
            first = second = 0.0
            for j in range(lane, lane + terms * lanes, lanes):
                first = exact_fma(w[a + j], w[b - j + 2 * lane], first)
                second = exact_fma(w[a + j], w[c - j + 2 * lane], second)
            w[in_b + lane], w[in_c + lane] = first, second

    def value(w, terms, a, at, out):
        value_and_slope(w, terms, a, at, out, None)

    def value_and_slope(w, terms, a, at, out, slope):
        for lane in range(lanes):
            total = rate = 0.0
            for k in range(terms - 1, -1, -1):
                rate = exact_fma(rate, w[at + lane], total)
                total = exact_fma(total, w[at + lane], w[a + k * lanes + lane])
            w[out + lane] = total
            if slope is not None:
                w[slope + lane] = rate

    return Sums(products, value, value_and_slope)


class _Vectors:
    """Instructions for vectors of some neighbouring lanes."""

    def __init__(
        self, lanes: int, wide: int, context: Any, builder: Any, kind: Any, array: Any
    ) -> None:
        self.builder, self.lanes = builder, lanes
        self.data = context.make_array(kind)(context, builder, array).data
        self.type = ir.VectorType(ir.DoubleType(), wide)
        self.zero = ir.Constant(self.type, [0.0] * wide)
        function = ir.FunctionType(self.type, [self.type] * 3)
        self.instruction = cgutils.get_or_insert_function(
            builder.module, function, f"llvm.fma.v{wide}f64"
        )

    def place(self, start: Any, count: Any = None, sign: int = 1) -> Any:
        if count is not None:
            shift = self.builder.mul(count, ir.Constant(count.type, sign * self.lanes))
            start = self.builder.add(start, shift)
        return self.builder.bitcast(self.builder.gep(self.data, [start]), self.type.as_pointer())

    def beside(self, start: Any, lane: int) -> Any:
        return self.builder.add(start, ir.Constant(start.type, lane))

    def load(self, start: Any, count: Any = None, sign: int = 1) -> Any:
        return self.builder.load(self.place(start, count, sign), align=8)

    def store(self, value: Any, start: Any) -> None:
        self.builder.store(value, self.place(start), align=8)

    def fma(self, a: Any, b: Any, c: Any) -> Any:
        return self.builder.call(self.instruction, [a, b, c])

    def total(self) -> Any:
        return cgutils.alloca_once_value(self.builder, self.zero)


def _compiled(lanes: int) -> Sums:
    """Return the sums as instructions for vectors: of all lanes, or as fit into registers."""
    wide = min(lanes, _WIDE)

    @intrinsic
    def products(
        typingctx: Any, w: Any, terms: Any, a: Any, b: Any, in_b: Any, c: Any, in_c: Any
    ) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            vectors = _Vectors(lanes, wide, context, builder, w, values[0])
            terms = values[1]
            for lane in range(0, lanes, wide):
                a, b, in_b, c, in_c = (vectors.beside(place, lane) for place in values[2:])
                first, second = vectors.total(), vectors.total()
                with cgutils.for_range(builder, terms) as loop:
                    common = vectors.load(a, loop.index)
                    for total, other in (first, b), (second, c):
                        factor = vectors.load(other, loop.index, -1)
                        builder.store(vectors.fma(common, factor, builder.load(total)), total)
                vectors.store(builder.load(first), in_b)
                vectors.store(builder.load(second), in_c)
            return context.get_dummy_value()

        return types.void(w, *[types.intp] * 6), generate

    def horner(context: Any, builder: Any, w: Any, values: Any, with_slope: bool) -> Any:
        vectors = _Vectors(lanes, lanes, context, builder, w, values[0])
        terms, a, at, out, *slope = values[1:]
        total, rate = vectors.total(), vectors.total()
        place = vectors.load(at)
        last = builder.sub(terms, ir.Constant(terms.type, 1))
        with cgutils.for_range(builder, terms) as loop:
            before = builder.load(total)
            if with_slope:
                builder.store(vectors.fma(builder.load(rate), place, before), rate)
            term = vectors.load(a, builder.sub(last, loop.index))
            builder.store(vectors.fma(before, place, term), total)
        vectors.store(builder.load(total), out)
        if with_slope:
            vectors.store(builder.load(rate), slope[0])
        return context.get_dummy_value()

    @intrinsic
    def value(typingctx: Any, w: Any, terms: Any, a: Any, at: Any, out: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            return horner(context, builder, w, values, False)

        return types.void(w, *[types.intp] * 4), generate

    @intrinsic
    def value_and_slope(
        typingctx: Any, w: Any, terms: Any, a: Any, at: Any, out: Any, slope: Any
    ) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            return horner(context, builder, w, values, True)

        return types.void(w, *[types.intp] * 5), generate

    return Sums(products, value, value_and_slope)


_config: Any = numba.config


def sums(lanes: int) -> Sums:
    """Return the sums for so many lanes; all are fused, products from the first term on."""
    return _plain(lanes) if _config.DISABLE_JIT else _compiled(lanes)
