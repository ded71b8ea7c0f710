// A law within the bounds of its parameter: as uq/sampling/truncation.py.

class Law {
  constructor(plain, args = plain.args) {
    this.plain = plain;
    this.kind = LAWS[plain.distribution];
    this.args = args;
    const {logDensity, tails} = this.kind.of(args);
    this.logDensity = logDensity;
    this.tails = x => x === -Infinity ? [0, 1] : x === Infinity ? [1, 0] : tails(x);
    const {lower = -Infinity, upper = Infinity} = this.kind.ends?.(args) ?? args;
    const [low, high] = plain.truncate ?? [-Infinity, Infinity];
    this.own = this.whole([Math.max(low, lower), Math.min(high, upper)]);
    this.bounds = [plain.bounds[0] ?? -Infinity, plain.bounds[1] ?? Infinity];
    this.within = this.given(this.bounds);
  }

  // The ends of whole numbers lie halfway between them.
  whole([low, high]) {
    return this.kind.discrete ? [Math.ceil(low) - 0.5, Math.floor(high) + 0.5] : [low, high];
  }

  // What a condition keeps: ends, the logarithm of the probability between them, and shares below and above.
  given(bounds) {
    const [least, most] = this.whole(bounds);
    const low = Math.max(least, this.own[0]), high = Math.min(most, this.own[1]);
    const [[below, notBelow], [notAbove, above]] = [this.tails(low), this.tails(high)];
    return {low, high, below, above, kept: low < high ? Math.max(notAbove - below, notBelow - above) : 0};
  }

  // Of a factor: the bounds that keep its product with another parameter within those of the parameter.
  beside(other) {
    const ends = this.bounds.map(end => end / other);
    return this.given(other < 0 ? ends.reverse() : ends);
  }

  // Its probability outside the bounds of the parameter.
  get outside() {
    return 1 - this.within.kept / this.given([-Infinity, Infinity]).kept;
  }

  // The same of each row. A law is that of one input: it keeps what it has found of all rows.
  besides(others) {
    return this.conditions ??= Array.from(others, other => this.beside(other));
  }

  // The logarithm of the density at each value; of a factor, given the other parameter.
  logDensities(values, others) {
    if (others) this.besides(others);
    return this.densities ??= values.map((x, row) => {
      const {low, high, kept} = others ? this.conditions[row] : this.within;
      return x < low || x > high ? -Infinity : this.logDensity(x) - Math.log(kept);
    });
  }

  // The probabilities below and above x under a condition.
  shares(x, {low, high, below, above, kept} = this.within) {
    if (x <= low || x >= high) return x <= low ? [0, 1] : [1, 0];
    const [less, more] = this.tails(x);
    return [(less - below) / kept, (more - above) / kept];
  }

  // Where a standard normal number has the same probability of less; of a positive quantity.
  at(z) {
    const side = z < 0 ? 0 : 1, share = normalBelow(-Math.abs(z));
    let [low, high] = [this.within.low, this.within.high].map(x => Math.log(Math.min(Math.max(x, 1e-300), 1e300)));
    while (high - low > 1e-15 * Math.max(1, Math.abs(low))) {
      const middle = (low + high) / 2;
      if (middle === low || middle === high) break;
      if ((this.shares(Math.exp(middle))[side] < share) === (side === 0)) low = middle; else high = middle;
    }
    return Math.exp((low + high) / 2);
  }

  // Whether it gives no number that is not positive.
  get isPositive() {
    return this.within.low > 0 || this.shares(0)[0] < 2 ** -54;
  }

  // The standard normal numbers behind values.
  normal(values) {
    return this.scores ??= values.map(x => normalAt(Math.min(Math.max(this.shares(x)[0], 2 ** -54), 1 - 2 ** -53)));
  }

  // The law with its spread times a factor, its middle moved.
  moved(factor, shift) {
    if (factor === 1 && (shift === 0 || this.kind.bounded)) return this;
    const args = {...this.args};
    for (const [name, value] of Object.entries(this.kind.moved(this.args, factor, shift))) {
      const old = this.args[name];
      args[name] = Array.isArray(value) ? value.map((one, i) => rounded(one, old[i])) : rounded(value, old);
    }
    if (this.kind.bounded && "lower" in args) {
      args.lower = Math.max(args.lower, this.args.lower);
      args.upper = Math.min(args.upper, this.args.upper);
    }
    const found = new Law(this.plain, args);
    return found.changes(this).length ? found : this;
  }

  // The arguments that differ from another's.
  changes(other) {
    return Object.entries(this.args).filter(([name, value]) => String(value) !== String(other.args[name]));
  }
}

// A number to be written, with six digits of its change.
function rounded(value, before) {
  if (value === before || value === 0) return value;
  const digits = Math.floor(Math.log10(Math.abs(value))) - Math.floor(Math.log10(Math.abs(value - before))) + 6;
  return Number(value.toPrecision(Math.min(Math.max(digits, 6), 17)));
}
