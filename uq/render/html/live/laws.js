// Laws of inputs: as uq/sampling/scipy_laws.py and uq/sampling/listed_values.py.

// Of each law, `of` its arguments: the logarithm of its density, and the probabilities below and above x,
// before any truncation. `moved` are its arguments when its spread is multiplied by a factor and its middle
// moved by some standard deviations.
const LAWS = {
  "normal": {
    of: ({mean, sd}) => ({
      logDensity: x => -(((x - mean) / sd) ** 2) / 2 - Math.log(sd * ROOT_OF_TURN),
      tails: x => normalTails((x - mean) / sd),
    }),
    moved: ({mean, sd}, factor, shift) => ({mean: mean + shift * sd, sd: factor * sd}),
  },
  "lognormal": {
    of(args) {
      const {median, sigma} = logarithmic(args), z = x => Math.log(x / median) / sigma;
      return {
        logDensity: x => -(z(x) ** 2) / 2 - Math.log(sigma * x * ROOT_OF_TURN),
        tails: x => x > 0 ? normalTails(z(x)) : [0, 1],
      };
    },
    moved(args, factor, shift) {
      const by = Math.exp(shift * logarithmic(args).sigma);
      if ("cv" in args) return {mean: args.mean * by, cv: factor * args.cv};
      return {median: args.median * by, sigma: factor * args.sigma};
    },
  },
  "uniform": {
    bounded: true,
    of: ({lower, upper}) => ({
      logDensity: () => -Math.log(upper - lower),
      tails: x => flat(lower, upper, x),
    }),
    moved: narrowed,
  },
  "loguniform": {
    bounded: true,
    of({lower, upper}) {
      const ends = [Math.log(lower), Math.log(upper)], height = -Math.log(ends[1] - ends[0]);
      return {
        logDensity: x => height - Math.log(x),
        tails: x => x > 0 ? flat(...ends, Math.log(x)) : [0, 1],
      };
    },
    moved({lower, upper}, factor, shift) {
      const ends = narrowed({lower: Math.log(lower), upper: Math.log(upper)}, factor, shift);
      return {lower: Math.exp(ends.lower), upper: Math.exp(ends.upper)};
    },
  },
  "triangular": {
    bounded: true,
    kinks: ({mode}) => [mode],
    of({lower, mode, upper}) {
      const width = upper - lower, height = Math.log(2 / width);
      return {
        logDensity: x => height + Math.log(x < mode ? (x - lower) / (mode - lower)
          : x > mode ? (upper - x) / (upper - mode) : 1),
        tails(x) {
          if (x <= lower || x >= upper) return x <= lower ? [0, 1] : [1, 0];
          if (x < mode) return complement((x - lower) ** 2 / width / (mode - lower));
          return complement((upper - x) ** 2 / width / (upper - mode)).reverse();
        },
      };
    },
    moved: narrowed,
  },
  "pert": {
    bounded: true,
    of({lower, mode, upper}) {
      const width = upper - lower;
      return LAWS.beta.of({
        alpha: 1 + 4 * (mode - lower) / width, beta: 1 + 4 * (upper - mode) / width, lower, upper,
      });
    },
    moved: narrowed,
  },
  "beta": {
    bounded: true,
    of({alpha, beta, lower, upper}) {
      const width = upper - lower, place = x => (x - lower) / width;
      const height = logGamma(alpha + beta) - logGamma(alpha) - logGamma(beta) - Math.log(width);
      const times = (power, log) => power === 0 ? 0 : power * log; // also where the logarithm is infinite
      return {
        logDensity: x => height + times(alpha - 1, Math.log(place(x))) + times(beta - 1, Math.log((upper - x) / width)),
        tails: x => [betaBelow(alpha, beta, place(x)), betaBelow(beta, alpha, (upper - x) / width)],
      };
    },
    moved: narrowed,
  },
  "weibull": {
    of: ({shape, scale}) => ({
      logDensity: x => Math.log(shape / scale) + (shape - 1) * Math.log(x / scale) - (x / scale) ** shape,
      tails: x => decaying(x > 0 ? (x / scale) ** shape : 0),
    }),
    moved: ({shape, scale}, factor, shift) => ({
      shape: shape / factor, scale: scale * Math.exp(shift * GUMBEL_SD / shape),
    }),
  },
  "gamma": {
    of({shape, scale}) {
      const height = -logGamma(shape) - shape * Math.log(scale);
      return {
        logDensity: x => height + (shape - 1) * Math.log(x) - x / scale,
        tails: x => gammaTails(shape, x / scale),
      };
    },
    // Of the same mean, times a factor.
    moved: ({shape, scale}, factor, shift) => ({
      shape: shape / factor ** 2, scale: scale * factor ** 2 * Math.exp(shift / Math.sqrt(shape)),
    }),
  },
  "gumbel": {
    of: ({mode, scale}) => ({
      logDensity: x => -Math.log(scale) - (x - mode) / scale - Math.exp((mode - x) / scale),
      tails: x => decaying(Math.exp((mode - x) / scale)).reverse(),
    }),
    moved: ({mode, scale}, factor, shift) => ({mode: mode + shift * GUMBEL_SD * scale, scale: factor * scale}),
  },
  "exponential": {
    scaleOnly: true,
    of: ({mean}) => ({
      logDensity: x => -Math.log(mean) - x / mean,
      tails: x => decaying(x > 0 ? x / mean : 0),
    }),
    moved: ({mean}, factor, shift) => ({mean: mean * Math.exp(shift)}),
  },
  "histogram": {
    bounded: true,
    kinks: ({edges}) => edges,
    ends: ({edges}) => ({lower: edges[0], upper: edges.at(-1)}),
    of({edges, counts}) {
      const sum = total(counts), below = [0];
      for (const count of counts) below.push(below.at(-1) + count / sum);
      const bin = x => Math.min(Math.max(edges.findLastIndex(edge => edge <= x), 0), counts.length - 1);
      return {
        logDensity(x) {
          const i = bin(x);
          return Math.log(counts[i] / sum / (edges[i + 1] - edges[i]));
        },
        tails(x) {
          const i = bin(x);
          return complement(below[i] + (below[i + 1] - below[i]) * flat(edges[i], edges[i + 1], x)[0]);
        },
      };
    },
    moved({edges}, factor, shift) {
      const ends = {lower: edges[0], upper: edges.at(-1)}, {lower} = narrowed(ends, factor, shift);
      return {edges: edges.map(edge => lower + factor * (edge - ends.lower))};
    },
  },
  // As if each whole number were spread over half a unit either side.
  "integer-range": {
    bounded: true,
    discrete: true,
    of: ({lower, upper}) => ({
      logDensity: () => -Math.log(upper - lower + 1),
      tails: x => flat(lower - 0.5, upper + 0.5, x),
    }),
    moved({lower, upper}, factor, shift) {
      const ends = narrowed({lower, upper}, factor, shift);
      const least = Math.min(Math.ceil(ends.lower - 1e-9), upper - 1);
      return {lower: least, upper: Math.max(Math.floor(ends.upper + 1e-9), least + 1)};
    },
  },
};
LAWS["truncated-normal"] = LAWS.normal;

const ROOT_OF_TURN = Math.sqrt(2 * Math.PI);
const GUMBEL_SD = Math.PI / Math.sqrt(6); // standard deviation of the logarithm of a unit exponential

function normalTails(z) {
  return [normalBelow(z), normalBelow(-z)];
}

function complement(below) {
  return [below, 1 - below];
}

// Below and above, where the probability above is exp(-hazard).
function decaying(hazard) {
  return [-Math.expm1(-hazard), Math.exp(-hazard)];
}

function flat(from, to, x) {
  return complement(Math.min(1, Math.max(0, (x - from) / (to - from))));
}

function logarithmic({mean, cv, median, sigma}) {
  if (cv === undefined) return {median, sigma};
  const variance = Math.log1p(cv * cv);
  return {median: Math.exp(Math.log(mean) - variance / 2), sigma: Math.sqrt(variance)};
}

// Ends within the old ones: there are no rows beyond.
function narrowed({lower, upper, mode}, factor, shift) {
  const half = (upper - lower) / 2, room = half * (1 - factor);
  const middle = (lower + upper) / 2 + Math.min(Math.max(shift * half / Math.sqrt(3), -room), room);
  const ends = {lower: middle - factor * half, upper: middle + factor * half};
  return mode === undefined ? ends : {...ends, mode: ends.lower + factor * (mode - lower)};
}
