// The laws of multiples of the logarithms of inputs, and of their sums: as uq/sampling/log_sums.py.

const FARTHEST = 8.2; // standard normal number beyond which a probability is negligible
const PANELS = 40, NODES = legendre(12);

// Nodes and weights of Gauss and Legendre's rule.
function legendre(n) {
  return Array.from({length: n}, (_, i) => {
    let x = Math.cos(Math.PI * (i + 0.75) / (n + 0.5)), slope;
    for (let k = 0; k < 10; k++) {
      let [before, now] = [1, x];
      for (let j = 2; j <= n; j++) [before, now] = [now, ((2 * j - 1) * x * now - (j - 1) * before) / j];
      slope = n * (x * now - before) / (x * x - 1);
      x -= now / slope;
    }
    return [x, 2 / ((1 - x * x) * slope * slope)];
  });
}

// A random number: `breaks` are its ends, and the places between them where its density is not smooth.
class Term {
  constructor(breaks, exactly) {
    const [first, ...later] = [...breaks].sort((a, b) => a - b), apart = 1e-12 * (later.at(-1) - first);
    this.breaks = later.reduce((kept, one) => one - kept.at(-1) > apart ? [...kept, one] : kept, [first]);
    this.table = new Polynomials(exactly, this.breaks);
  }

  // The probability of less.
  below(t) {
    if (!(t > this.breaks[0])) return 0;
    return t >= this.breaks.at(-1) ? 1 : Math.min(1, Math.max(0, this.table.at(t)));
  }
}

// A multiple of the logarithm of an input.
class LogTerm extends Term {
  constructor(law, exponent) {
    const of = x => exponent * Math.log(x), inner = law.kind.kinks?.(law.args) ?? [];
    const ends = [law.at(-FARTHEST), law.at(FARTHEST)];
    const breaks = [...ends, ...inner.filter(x => x > ends[0] && x < ends[1])].map(of);
    super(breaks, t => law.shares(Math.exp(t / exponent))[exponent > 0 ? 0 : 1]);
    const places = Array.from({length: PANELS - 1}, (_, i) => of(law.at((2 * (i + 1) / PANELS - 1) * FARTHEST)));
    const all = [...new Set([...this.breaks, ...places])].sort((a, b) => a - b);
    const kept = Math.log(law.within.kept);
    this.density = t => {
      const x = Math.exp(t / exponent);
      return Math.exp(law.logDensity(x) - kept + t / exponent) / Math.abs(exponent);
    };
    this.panels = all.slice(1).map((high, i) => ({low: all[i], high, nodes: this.nodes(all[i], high)}));
  }

  // Places with their probabilities.
  nodes(low, high) {
    const half = (high - low) / 2, middle = (low + high) / 2;
    return NODES.map(([x, weight]) => {
      const t = middle + half * x;
      return [t, half * weight * this.density(t)];
    });
  }

  get spread() {
    const nodes = this.panels.flatMap(one => one.nodes), mean = total(nodes.map(([t, weight]) => t * weight));
    return Math.sqrt(total(nodes.map(([t, weight]) => (t - mean) ** 2 * weight)));
  }
}

// A law keeps its term: most laws stay as they are when one is moved.
function logTermOf(law, exponent) {
  if (law.term?.exponent !== exponent) law.term = Object.assign(new LogTerm(law, exponent), {exponent});
  return law.term;
}

// The probability that `first` and `second` together are less than a value.
function together(first, second, value) {
  const kinks = first.breaks.map(one => value - one).reverse();
  const over = nodes => {
    let sum = 0;
    for (let i = 0; i < nodes.length; i++) sum += nodes[i][1] * first.below(value - nodes[i][0]);
    return sum;
  };
  let sum = 0;
  for (const {low, high, nodes} of second.panels) {
    if (low >= kinks.at(-1)) break; // beyond all that `first` can be
    const inside = kinks.filter(one => one > low && one < high);
    if (!inside.length) sum += over(nodes);
    else [low, ...inside].forEach((from, i) => { sum += over(second.nodes(from, inside[i] ?? high)); });
  }
  return sum;
}

// The law of a sum of independent terms.
function sumOf(terms) {
  const [widest, ...others] = terms.map(term => [term, term.spread]).sort((a, b) => b[1] - a[1]).map(([term]) => term);
  return others.reduce((first, second) => new Term(
    first.breaks.flatMap(one => second.breaks.map(other => one + other)), value => together(first, second, value)
  ), widest);
}
