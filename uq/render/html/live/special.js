// Special functions, to about twelve digits.

const ROUNDING = 64 * Number.EPSILON;

function total(numbers) {
  let sum = 0;
  for (const one of numbers) sum += one;
  return sum;
}

// The normal law's probability of less than x (J. F. Hart, Computer Approximations, 1968, as given by
// G. West, "Better approximations to cumulative normal functions", Wilmott, May 2005).
function normalBelow(x) {
  const z = Math.abs(x);
  let tail = 0;
  if (z < 7.07106781186547) {
    const above = ((((((0.0352624965998911 * z + 0.700383064443688) * z + 6.37396220353165) * z
      + 33.912866078383) * z + 112.079291497871) * z + 221.213596169931) * z + 220.206867912376);
    const below = (((((((0.0883883476483184 * z + 1.75566716318264) * z + 16.064177579207) * z
      + 86.7807322029461) * z + 296.564248779674) * z + 637.333633378831) * z + 793.826512519948) * z
      + 440.413735824752);
    tail = Math.exp(-z * z / 2) * above / below;
  } else if (z < 38) {
    let fraction = z + 0.65;
    for (let n = 20; n > 0; n--) fraction = z + n / fraction;
    tail = Math.exp(-z * z / 2) / fraction / Math.sqrt(2 * Math.PI);
  }
  return x > 0 ? 1 - tail : tail;
}

// Where the normal law has this probability of less: Halley's steps from M. Abramowitz and I. A. Stegun,
// Handbook of Mathematical Functions (1964), 26.2.23.
function normalAt(probability) {
  if (probability > 0.5) return -normalAt(1 - probability);
  const t = Math.sqrt(-2 * Math.log(probability));
  let z = (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308))) - t;
  for (let i = 0; i < 3; i++) {
    const error = (normalBelow(z) - probability) * Math.sqrt(2 * Math.PI) * Math.exp(z * z / 2);
    z -= error / (1 + z * error / 2);
  }
  return z;
}

// C. Lanczos, SIAM J. Numer. Anal. 1, 86 (1964).
function logGamma(x) {
  const c = [
    0.99999999999980993, 676.5203681218851, -1259.1392167224028, 771.32342877765313,
    -176.61502916214059, 12.507343278686905, -0.13857109526572012, 9.9843695780195716e-6,
    1.5056327351493116e-7,
  ];
  if (x < 0.5) return Math.log(Math.PI / Math.sin(Math.PI * x)) - logGamma(1 - x);
  let sum = c[0];
  for (let i = 1; i < 9; i++) sum += c[i] / (x - 1 + i);
  const t = x + 6.5;
  return 0.5 * Math.log(2 * Math.PI) + (x - 0.5) * Math.log(t) - t + Math.log(sum);
}

// The regularised incomplete beta function, by Lentz's continued fraction.
function betaBelow(a, b, x) {
  if (x <= 0 || x >= 1) return x <= 0 ? 0 : 1;
  if (x > (a + 1) / (a + b + 2)) return 1 - betaBelow(b, a, 1 - x);
  const front = Math.exp(
    logGamma(a + b) - logGamma(a) - logGamma(b) + a * Math.log(x) + b * Math.log1p(-x)
  ) / a;
  const least = 1e-300, away = value => Math.abs(value) < least ? least : value;
  let c = 1, d = 1 / away(1 - (a + b) * x / (a + 1)), fraction = d;
  for (let m = 1; m < 10000; m++) {
    const even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    for (const term of [even, odd]) {
      d = 1 / away(1 + term * d);
      c = away(1 + term / c);
      fraction *= c * d;
    }
    if (Math.abs(c * d - 1) < 1e-15) break;
  }
  return front * fraction;
}

// The regularised incomplete gamma functions, below and above x: a series, or Lentz's continued fraction.
function gammaTails(a, x) {
  if (!(x > 0)) return [0, 1];
  if (x === Infinity) return [1, 0];
  const front = Math.exp(a * Math.log(x) - x - logGamma(a));
  if (x < a + 1) {
    let term = 1 / a, sum = term;
    for (let n = 1; term > sum * 1e-17; n++) sum += term *= x / (a + n);
    const below = Math.min(front * sum, 1);
    return [below, 1 - below];
  }
  let b = x + 1 - a, c = Infinity, d = 1 / b, fraction = d;
  for (let n = 1; n < 100000; n++) {
    const factor = n * (a - n);
    b += 2;
    d = 1 / (b + factor * d);
    c = b + factor / c;
    fraction *= c * d;
    if (Math.abs(c * d - 1) < 1e-15) break;
  }
  const above = Math.min(front * fraction, 1);
  return [1 - above, above];
}

function betaQuantile(a, b, probability) {
  let low = 0, high = 1;
  for (let i = 0; i < 100 && high - low > 1e-16 * high; i++) {
    const middle = (low + high) / 2;
    if (betaBelow(a, b, middle) < probability) low = middle; else high = middle;
  }
  return (low + high) / 2;
}
