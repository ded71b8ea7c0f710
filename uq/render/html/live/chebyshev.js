// A smooth function between ascending breaks as Chebyshev polynomials, in pieces halved until each is
// accurate.

const DEGREE = 24, DEEPEST = 12, ACCURACY = 1e-11, CHECKED = [-0.97, -0.31, 0.44, 0.99];
const PLACES_OF_NODES = Array.from({length: DEGREE + 1}, (_, i) => Math.cos(Math.PI * (i + 0.5) / (DEGREE + 1)));

class Polynomials {
  constructor(of, breaks) {
    const pieces = [], waiting = breaks.slice(1).map((high, i) => [breaks[i], high, 0]);
    while (waiting.length) {
      const [low, high, depth] = waiting.pop(), middle = (low + high) / 2;
      const value = x => of(middle + (high - low) / 2 * x), c = fitted(value);
      if (depth < DEEPEST && CHECKED.some(x => Math.abs(chebyshev(c, x) - value(x)) > ACCURACY)) {
        waiting.push([low, middle, depth + 1], [middle, high, depth + 1]);
      } else pieces.push({low, high, c});
    }
    this.pieces = pieces.sort((a, b) => a.low - b.low);
    this.ends = Float64Array.from([...this.pieces.map(one => one.low), this.pieces.at(-1).high]);
  }

  // The value within the ends.
  at(t) {
    const {ends, pieces} = this;
    let first = 0, last = pieces.length - 1;
    while (first < last) {
      const middle = (first + last) >> 1;
      if (t <= ends[middle + 1]) last = middle; else first = middle + 1;
    }
    const {low, high, c} = pieces[first];
    return chebyshev(c, (2 * t - low - high) / (high - low));
  }
}

function fitted(of) {
  const n = DEGREE + 1, values = PLACES_OF_NODES.map(of);
  return Float64Array.from({length: n}, (_, j) => {
    let sum = 0;
    for (let i = 0; i < n; i++) sum += values[i] * Math.cos(Math.PI * j * (i + 0.5) / n);
    return sum * (j ? 2 : 1) / n;
  });
}

function chebyshev(c, x) {
  let one = 0, two = 0;
  for (let i = c.length - 1; i > 0; i--) {
    const next = 2 * x * one - two + c[i];
    two = one;
    one = next;
  }
  return x * one - two + c[0];
}
