// Weights of rows, smoothed, and whether they can be trusted: as uq/stats/importance_weights.py.
// A. Vehtari et al., "Pareto smoothed importance sampling", J. Mach. Learn. Res. 25, 72 (2024).

const FEWEST = 5, HOPELESS = 0.7, NEGLIGIBLE = 1e-3;

// The number of rows of equal weight that are worth as much (L. Kish).
function effectiveRows(numbers) {
  let sum = 0, squares = 0;
  for (const one of numbers) { sum += one; squares += one * one; }
  return squares > 0 ? sum * sum / squares : 0;
}

// The sum of each sample of several rows by its number.
function sumsOf(numbers, sample) {
  const sums = new Map();
  numbers.forEach((one, row) => sums.set(sample[row], (sums.get(sample[row]) ?? 0) + one));
  return sums;
}

// The sum of each sample of several rows, else the numbers themselves.
function perSample(numbers, sample) {
  return sample ? Float64Array.from(sumsOf(numbers, sample).values()) : numbers;
}

// Shape and scale of a generalised Pareto law of ascending numbers (J. Zhang, M. A. Stephens,
// Technometrics 51, 316 (2009)).
function generalisedPareto(excess) {
  const n = excess.length, points = 30 + Math.floor(Math.sqrt(n));
  const quartile = excess[Math.floor(n / 4 + 0.5) - 1];
  const shapeOf = theta => {
    let sum = 0;
    for (const one of excess) sum += Math.log1p(-theta * one);
    return sum / n;
  };
  const found = [];
  for (let i = 0; i < points; i++) {
    const theta = 1 / excess[n - 1] + (1 - Math.sqrt(points / (i + 0.5))) / (3 * quartile);
    if (theta === 0) continue;
    const shape = shapeOf(theta);
    found.push([theta, n * (Math.log(-theta / shape) - shape - 1)]);
  }
  const most = Math.max(...found.map(([, likelihood]) => likelihood));
  let sum = 0, weights = 0;
  for (const [theta, likelihood] of found) {
    const weight = Math.exp(likelihood - most);
    sum += theta * weight;
    weights += weight;
  }
  const theta = sum / weights, shape = shapeOf(theta);
  return [shape, -shape / theta];
}

function shrunk(shape, size) {
  return (size * shape + 5) / (size + 10);
}

function tailSize(rows) {
  return Math.ceil(Math.min(rows / 5, 3 * Math.sqrt(rows)));
}

// The largest of some numbers, ascending.
function largest(numbers, count) {
  let kept = [], least = -Infinity;
  const top = () => Float64Array.from(kept).sort().slice(-count);
  for (let i = 0; i < numbers.length; i++) {
    if (!(numbers[i] > least)) continue;
    kept.push(numbers[i]);
    if (kept.length < 8 * count) continue;
    kept = [...top()];
    least = kept[0];
  }
  return top();
}

// The shape of the law of the largest; -Infinity where all are equal, Infinity where they are few.
function tailShape(numbers) {
  const n = numbers.length, count = tailSize(n), top = largest(numbers, count + 1), most = top.at(-1);
  const counted = numbers.filter(one => one > NEGLIGIBLE * most), m = counted.length;
  if (m === 0 || (m === n && most - numbers.reduce((a, b) => Math.min(a, b)) <= ROUNDING * most)) return -Infinity;
  if (m < FEWEST) return Infinity;
  const above = m > count ? top.filter(one => one > top[0]) : [];
  const excess = 2 * above.length > count ? above.map(one => one - top[0]) : counted.sort();
  if (excess.at(-1) === excess[0]) return excess.length > 1 ? -Infinity : Infinity;
  return shrunk(generalisedPareto(excess)[0], excess.length);
}

function withSmoothTail(raw) {
  const count = tailSize(raw.length), top = largest(raw, count + 1), cut = top[0], most = top.at(-1);
  if (!(top[1] > cut)) return raw;
  const tail = [];
  raw.forEach((one, row) => { if (one > cut) tail.push(row); });
  tail.sort((a, b) => raw[a] - raw[b] || a - b);
  const [shape, scale] = generalisedPareto(tail.map(row => raw[row] - cut)), k = shrunk(shape, count);
  const weights = Float64Array.from(raw);
  tail.forEach((row, i) => {
    const p = (i + 0.5) / count;
    weights[row] = Math.min(cut + scale * Math.expm1(-k * Math.log1p(-p)) / k, most);
  });
  return weights;
}

// Where samples have several rows, the weight of all of a sample's is smoothed: samples are independent.
function smoothedSamples(raw, sample) {
  const sums = sumsOf(raw, sample), smooth = withSmoothTail(Float64Array.from(sums.values())), factors = new Map();
  [...sums].forEach(([one, sum], i) => factors.set(one, sum > 0 ? smooth[i] / sum : 0));
  return raw.map((one, row) => one * factors.get(sample[row]));
}

function smoothed(logWeights, sample) {
  const most = logWeights.reduce((a, b) => b > a ? b : a, -Infinity);
  if (most === -Infinity) return {refusal: "no row of this result is possible under the other laws"};
  const raw = logWeights.map(one => isNaN(one) ? 0 : Math.exp(one - most));
  const ofSamples = perSample(raw, sample), k = tailShape(ofSamples);
  const smooth = () => sample ? smoothedSamples(raw, sample) : withSmoothTail(raw);
  const weights = isFinite(k) ? smooth() : raw, mean = total(weights) / weights.length;
  return {
    weights: weights.map(one => one / mean), k, rows: ofSamples.length,
    effective: effectiveRows(perSample(weights, sample)), refusal: refusal(k, ofSamples.length),
  };
}

// Why weights cannot be trusted, or "".
function refusal(k, rows) {
  const most = rows > 10 ? Math.min(HOPELESS, 1 - 1 / Math.log10(rows)) : -Infinity;
  if (k <= most || k === -Infinity) return "";
  if (most === -Infinity) return `weights rest on ${rows} independent part${rows > 1 ? "s" : ""}, and more than 10 are needed`;
  if (k === Infinity) {
    return `fewer than ${FEWEST} samples have weight there: it takes ${2 * rows} samples or more instead of ${rows}`;
  }
  if (k < HOPELESS) {
    const needed = Math.max(Math.ceil(10 ** (1 / (1 - Math.max(k, 0)))), rows + 1);
    return `this takes about ${needed} samples instead of ${rows}`
      + ` (Pareto k ${k.toFixed(2)}, limit ${most.toFixed(2)})`;
  }
  return "too few rows lie where the other laws do; run them as a study of their own, or with many times the rows"
    + ` (Pareto k ${k.toFixed(2)})`;
}
