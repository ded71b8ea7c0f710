// How the inputs of the chosen rows differ from those of the others: as inputs_apart in uq/assess/earliest.py.

const MOST_INPUTS = 8;

// The rank of each value, from 0 to 1; equal values share theirs. With its distance from the middle.
function ranksOf(column) {
  if (column.ranked) return column.ranked;
  const {order, values} = column, ranks = new Float64Array(values.length);
  for (let start = 0, end = 0; start < order.length; start = end) {
    while (end < order.length && values[order[end]] === values[order[start]]) end++;
    for (let i = start; i < end; i++) ranks[order[i]] = (start + end) / 2 / order.length;
  }
  const distances = ranks.map(one => Math.abs(one - 0.5));
  return column.ranked = {ranks, distances, middle: total(distances) / distances.length};
}

// The median of the rows that are chosen, or of those that are not.
function medianAmong({order, values}, mask, chosen, count) {
  const own = [];
  for (let i = 0; own.length <= count / 2; i++) if (mask[order[i]] === chosen) own.push(order[i]);
  return count % 2 ? values[own.at(-1)] : (values[own.at(-2)] + values[own.at(-1)]) / 2;
}

// The mean of the chosen rows, of numbers between 0 and 1, with Student's interval of the rows, or of the parts that are independent;
// of independent ones it allows for two more outliers, as beyond_outliers in uq/stats/intervals.py.
function meanAmong(rows, values, mask, count) {
  const part = rows.replicate ?? rows.sample, kept = new Float64Array(count), parts = part && new Int32Array(count);
  for (let row = 0, i = 0; i < count; row++) {
    if (!mask[row]) continue;
    if (part) parts[i] = part[row];
    kept[i++] = values[row];
  }
  const own = rows.independent ? kept : [], mean = total(kept) / count;
  const estimates = part ? estimatesOf(kept, parts, Boolean(rows.replicate)).estimates : own;
  const size = estimates.length, centre = total(estimates) / size;
  const scatter = total(estimates.map(one => (one - centre) ** 2)) / (size - 1) / size;
  const half = size > 1 && scatter > 0 ? student(rows.students, size - 1) * Math.sqrt(scatter) : NaN;
  let least = centre, most = centre;
  for (const estimate of estimates) [least, most] = [Math.min(least, estimate), Math.max(most, estimate)];
  const moved = rows.replicate ? 0 : 2 * (most + least - 2 * mean) / size;
  return {mean, low: Math.max(mean - half + Math.min(moved, 0), 0), high: Math.min(mean + half + Math.max(moved, 0), 1)};
}

function isClear({low, high}, middle) {
  return low > middle || high < middle;
}

// Where the mean rank is not clearly another, the chosen rows may still lie nearer the middle, or farther from it.
function apart(rows, column, mask, count) {
  const {ranks, distances, middle} = ranksOf(column), rank = meanAmong(rows, ranks, mask, count);
  const found = {
    column, rank, median: medianAmong(column, mask, 1, count), others: medianAmong(column, mask, 0, rows.count - count),
  };
  if (isClear(rank, 0.5)) return {...found, size: Math.abs(rank.mean - 0.5), more: ""};
  const distance = meanAmong(rows, distances, mask, count), away = distance.mean - middle;
  if (!isClear(distance, middle)) return {...found, size: Math.abs(rank.mean - 0.5), more: "not clear"};
  return {...found, size: Math.abs(away) / 0.5, more: away > 0 ? "away from the middle" : "near the middle"};
}

class InputsApart {
  constructor(selection) {
    Object.assign(this, {selection, rows: selection.rows});
    this.columns = this.rows.columns.filter(one => one.role === "input");
    [this.first, this.second] = [0, 1].map(() => make("table", {class: "found inputs-apart"}));
    this.summary = make("summary");
    this.rest = make("details", {}, this.summary, make("div", {class: "wide"}, this.second));
    this.element = make("div", {hidden: true}, make("div", {class: "wide"}, this.first), this.rest, make("p", {class: "note"},
      "Of each input the median, and the mean rank of the chosen rows among all: from 0 % where they have the lowest values"
      + " to 100 % where they have the highest. The inputs that differ most come first."));
    laterOf()(this.prepared());
    selection.listeners.push(() => this.show());
  }

  // Sorting takes longer than a brush may.
  *prepared() {
    for (const one of this.columns) yield ranksOf(one);
  }

  show() {
    const {isAll, mask, count} = this.selection, others = this.rows.count - count;
    this.element.hidden = isAll || !count || !others;
    if (this.element.hidden) return;
    const found = this.columns.map(one => apart(this.rows, one, mask, count)).sort((a, b) => b.size - a.size);
    const heads = ["Input", `${grouped(count)} chosen`, `${grouped(others)} others`, "mean rank"];
    const head = () => make("thead", {}, make("tr", {}, ...heads.map(text => make("th", {scope: "col"}, text))));
    const fill = (table, some) => table.replaceChildren(head(), make("tbody", {}, ...some.map(lineOf)));
    const more = found.splice(MOST_INPUTS);
    fill(this.first, found);
    fill(this.second, more);
    this.rest.hidden = !more.length;
    this.summary.textContent = more.length === 1 ? "1 more input" : `${more.length} more inputs`;
  }
}

function lineOf({column, median, others, rank, more}) {
  const middle = value => make("td", {class: "number"}, data(value, column.digits(value, 3)));
  const shifted = cellOf({share: rank.mean, low: rank.low, high: rank.high, more});
  return make("tr", {"data-key": `input/${column.name}`},
    make("th", {scope: "row", title: column.meaning}, ...named(column), column.unit && ` [${column.unit}]`), middle(median), middle(others), shifted);
}
