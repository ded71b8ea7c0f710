// The 95 % interval of a share of rows: as in uq/stats/intervals.py and uq/stats/intervals.py.

const NORMAL = 1.959963984540054, FEW_HITS = 20, NONE = [NaN, NaN];

// Wilson's, with an effective number of rows.
function wilson(share, rows, z = NORMAL) {
  const w = z * z / rows;
  const high = (share + w / 2 + Math.sqrt(w * share * (1 - share) + w * w / 4)) / (1 + w);
  const low = share * share / (1 + w) / high;
  return [low, 1 - (1 - share) ** 2 / (1 + w) / (1 - low)];
}

// Clopper and Pearson's, for few hits or misses.
function exact(share, rows) {
  let hits = share * rows;
  if (Math.abs(hits - Math.round(hits)) < 1e-9) hits = Math.round(hits);
  const misses = Math.max(rows - hits, 0);
  const low = hits > 0 ? betaQuantile(hits, misses + 1, 0.025) : 0;
  const high = misses > 0 ? betaQuantile(hits + 1, misses, 0.975) : 1;
  return [low, high];
}

function areFew(share, rows, below = FEW_HITS) {
  return Number((Math.min(share, 1 - share) * rows).toFixed(6)) < below;
}

function binomial(share, rows) {
  return areFew(share, rows) ? exact(share, rows) : wilson(share, rows);
}

// Student's quantile, from a table or by Cornish and Fisher's expansion.
function student(students, degrees) {
  if (degrees + 1 < students.length) return students[degrees + 1];
  const z = NORMAL, z3 = z ** 3, z5 = z ** 5, z7 = z ** 7, z9 = z ** 9;
  return z + (z3 + z) / (4 * degrees) + (5 * z5 + 16 * z3 + 3 * z) / (96 * degrees ** 2)
    + (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * degrees ** 3)
    + (79 * z9 + 776 * z7 + 1482 * z5 - 1920 * z3 - 945 * z) / (92160 * degrees ** 4);
}

// From what independent parts estimate: replicates, or samples of several rows, then with their number. The
// estimates may be those of another share.
function scattered(share, count, estimates, students, samples, at = share) {
  const parts = estimates.length;
  if (parts < 2) return NONE;
  const mean = estimates.reduce((a, b) => a + b) / parts;
  const scatter = estimates.reduce((sum, one) => sum + (one - mean) ** 2, 0) / (parts - 1) / parts;
  const known = estimates.some(one => one !== estimates[0]) && at > 0 && at < 1;
  const worth = known ? at * (1 - at) / scatter : NaN, wide = student(students, parts - 1);
  if (count === null) return wilson(share, worth, wide);
  const limit = known || samples === null ? count : Math.min(count, samples);
  const effective = known ? Math.min(worth * (NORMAL / wide) ** 2, limit) : limit;
  return areFew(share, samples === null ? count : effective) ? exact(share, effective) : wilson(share, worth, wide);
}

// The share of hits, and what each part says of it: replicates their shares; samples, which may have unlike
// numbers of rows, their pulls.
function estimatesOf(hits, parts, areReplicates) {
  const counts = new Map(), sums = new Map();
  hits.forEach((hit, i) => {
    counts.set(parts[i], (counts.get(parts[i]) ?? 0) + 1);
    sums.set(parts[i], (sums.get(parts[i]) ?? 0) + hit);
  });
  const share = total(hits) / hits.length;
  return {share, estimates: [...counts].map(([part, count]) => areReplicates ? sums.get(part) / count
    : share + counts.size * (sums.get(part) - count * share) / hits.length)};
}

// Share and interval of hits (0, 1, or NaN where a row does not take part) among chosen rows.
function shareOf(rows, hits, mask) {
  const part = rows.replicate ?? rows.sample, kept = [], parts = [];
  for (let row = 0; row < hits.length; row++) {
    if (!mask[row] || isNaN(hits[row])) continue;
    kept.push(hits[row]);
    if (part) parts.push(part[row]);
  }
  const count = kept.length, share = total(kept) / count;
  let ends = NONE;
  if (count && part) {
    const {estimates} = estimatesOf(kept, parts, Boolean(rows.replicate));
    ends = scattered(share, count, estimates, rows.students, rows.samples);
  } else if (count && rows.independent) ends = binomial(share, count);
  return {share, count, low: ends[0], high: ends[1]};
}
