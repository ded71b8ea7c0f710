// The 95 % interval of a share of rows: as in uq/intervals.py and uq/exact_shares.py.

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

function areFew(share, rows) {
  return Number((Math.min(share, 1 - share) * rows).toFixed(6)) < FEW_HITS;
}

function binomial(share, rows) {
  return areFew(share, rows) ? exact(share, rows) : wilson(share, rows);
}

// From the scatter of the replicates that have rows; `students` are quantiles by number of them.
function scattered(share, rows, estimates, students) {
  const count = estimates.length;
  if (count < 2) return NONE;
  const mean = estimates.reduce((a, b) => a + b) / count;
  const scatter = estimates.reduce((sum, one) => sum + (one - mean) ** 2, 0) / (count - 1) / count;
  const known = scatter > 0 && share > 0 && share < 1;
  const worth = known ? share * (1 - share) / scatter : NaN, wide = students[count];
  if (areFew(share, rows)) {
    const effective = known ? Math.min(worth * (NORMAL / wide) ** 2, rows) : rows;
    return exact(share, effective);
  }
  return wilson(share, worth, wide);
}

// Share and interval of hits (0, 1, or NaN where a row does not take part) among chosen rows.
function shareOf(rows, hits, mask) {
  let count = 0, sum = 0;
  const counts = new Map(), sums = new Map();
  for (let row = 0; row < hits.length; row++) {
    if (!mask[row] || isNaN(hits[row])) continue;
    count++;
    sum += hits[row];
    if (rows.replicate) {
      const one = rows.replicate[row];
      counts.set(one, (counts.get(one) ?? 0) + 1);
      sums.set(one, (sums.get(one) ?? 0) + hits[row]);
    }
  }
  const share = sum / count;
  let ends = NONE;
  if (count && rows.replicate) {
    const estimates = [...counts.keys()].sort((a, b) => a - b).map(one => sums.get(one) / counts.get(one));
    ends = scattered(share, count, estimates, rows.students);
  } else if (count && rows.independent) ends = binomial(share, count);
  return {share, count, low: ends[0], high: ends[1]};
}
