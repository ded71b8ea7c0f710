// Laws of inputs whose density is simple: as uq/inputs/distributions.py and uq/inputs/conditioning.py.

// Of each law: the logarithm of its density at x before any truncation; the probabilities below and
// above x; and its arguments when its spread is multiplied by a factor and its middle moved by some
// standard deviations.
const LAWS = {
  "normal": {
    logDensity: ({mean, sd}, x) => -(((x - mean) / sd) ** 2) / 2 - Math.log(sd),
    tails: ({mean, sd}, x) => tails((x - mean) / sd),
    moved: ({mean, sd}, factor, shift) => ({mean: mean + shift * sd, sd: factor * sd}),
  },
  "lognormal": {
    logDensity(law, x) {
      const {median, sigma} = logarithmic(law);
      return -((Math.log(x / median) / sigma) ** 2) / 2 - Math.log(sigma * x);
    },
    tails(law, x) {
      const {median, sigma} = logarithmic(law);
      return x > 0 ? tails(Math.log(x / median) / sigma) : [0, 1];
    },
    moved(law, factor, shift) {
      const {sigma} = logarithmic(law), by = Math.exp(shift * sigma);
      if ("cv" in law) return {mean: law.mean * by, cv: factor * law.cv};
      return {median: law.median * by, sigma: factor * law.sigma};
    },
  },
  "uniform": {
    bounded: true,
    logDensity: ({lower, upper}) => -Math.log(upper - lower),
    tails: ({lower, upper}, x) => flat(lower, upper, x),
    moved: ({lower, upper}, factor, shift) => narrowed(lower, upper, factor, shift),
  },
  "loguniform": {
    bounded: true,
    logDensity: ({lower, upper}, x) => -Math.log(x * Math.log(upper / lower)),
    tails: ({lower, upper}, x) => x > 0 ? flat(Math.log(lower), Math.log(upper), Math.log(x)) : [0, 1],
    moved({lower, upper}, factor, shift) {
      const moved = narrowed(Math.log(lower), Math.log(upper), factor, shift);
      return {lower: Math.exp(moved.lower), upper: Math.exp(moved.upper)};
    },
  },
  "triangular": {
    bounded: true,
    logDensity({lower, mode, upper}, x) {
      const height = x < mode ? (x - lower) / (mode - lower) : x > mode ? (upper - x) / (upper - mode) : 1;
      return Math.log(2 * height / (upper - lower));
    },
    tails({lower, mode, upper}, x) {
      if (x <= lower || x >= upper) return x <= lower ? [0, 1] : [1, 0];
      const width = upper - lower;
      const below = x < mode ? (x - lower) ** 2 / width / (mode - lower) : 1 - (upper - x) ** 2 / width / (upper - mode);
      return [below, 1 - below];
    },
    moved({lower, mode, upper}, factor, shift) {
      const ends = narrowed(lower, upper, factor, shift);
      return {...ends, mode: ends.lower + factor * (mode - lower)};
    },
  },
};
LAWS["truncated-normal"] = LAWS.normal;

function tails(z) {
  return [normalBelow(z), normalBelow(-z)];
}

function flat(from, to, x) {
  const below = Math.min(1, Math.max(0, (x - from) / (to - from)));
  return [below, 1 - below];
}

function logarithmic({mean, cv, median, sigma}) {
  if (cv === undefined) return {median, sigma};
  const variance = Math.log1p(cv * cv);
  return {median: Math.exp(Math.log(mean) - variance / 2), sigma: Math.sqrt(variance)};
}

// Ends within the old ones: there are no rows beyond.
function narrowed(lower, upper, factor, shift) {
  const half = (upper - lower) / 2, room = half * (1 - factor);
  const middle = (lower + upper) / 2 + Math.min(Math.max(shift * half / Math.sqrt(3), -room), room);
  return {lower: middle - factor * half, upper: middle + factor * half};
}

// A law that `plain` states, within the bounds of its parameter.
class Law {
  constructor(plain, args = plain.args) {
    this.plain = plain;
    this.kind = LAWS[plain.distribution];
    this.args = args;
    const {lower = -Infinity, upper = Infinity} = args, [low, high] = plain.truncate ?? [-Infinity, Infinity];
    const [least, most] = plain.bounds;
    this.own = [Math.max(low, lower), Math.min(high, upper)];
    this.ends = [Math.max(least ?? -Infinity, this.own[0]), Math.min(most ?? Infinity, this.own[1])];
    this.kept = this.between(this.ends);
    this.below = this.tails(this.ends[0])[0];
  }

  tails(x) {
    if (x === -Infinity) return [0, 1];
    return x === Infinity ? [1, 0] : this.kind.tails(this.args, x);
  }

  between(ends) {
    const [[below, notBelow], [notAbove, above]] = ends.map(end => this.tails(end));
    return Math.max(notAbove - below, notBelow - above);
  }

  // Its probability outside the bounds of the parameter.
  get outside() {
    return 1 - this.kept / this.between(this.own);
  }

  // The logarithm of the density at each value.
  logDensities(values) {
    const [low, high] = this.ends, kept = Math.log(this.kept);
    return values.map(x => x < low || x > high ? -Infinity : this.kind.logDensity(this.args, x) - kept);
  }

  probability(x) {
    if (x < this.ends[0]) return 0;
    return Math.min(1, Math.max(0, (this.tails(x)[0] - this.below) / this.kept));
  }

  // The law with its spread times a factor, its middle moved; arguments are rounded to be written.
  moved(factor, shift) {
    if (factor === 1 && shift === 0) return this;
    const args = {...this.args};
    for (const [name, value] of Object.entries(this.kind.moved(this.args, factor, shift))) {
      args[name] = Number(value.toPrecision(6));
    }
    if (this.kind.bounded) {
      args.lower = Math.max(args.lower, this.args.lower);
      args.upper = Math.min(args.upper, this.args.upper);
    }
    return new Law(this.plain, args);
  }

  // The arguments that differ from another's.
  changes(other) {
    return Object.entries(this.args).filter(([name, value]) => value !== other.args[name]);
  }
}
