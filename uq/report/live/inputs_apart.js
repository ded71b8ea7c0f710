// How the inputs of the chosen rows differ from those of the others: as inputs_apart in uq/analysis/earliest.py.

const MOST_INPUTS = 8;

// The rank of each value, from 0 to 1; equal values share theirs.
function ranksOf(column) {
  if (column.ranks) return column.ranks;
  const {order, values} = column, ranks = column.ranks = new Float64Array(values.length);
  for (let start = 0, end = 0; start < order.length; start = end) {
    while (end < order.length && values[order[end]] === values[order[start]]) end++;
    for (let i = start; i < end; i++) ranks[order[i]] = (start + end) / 2 / order.length;
  }
  return ranks;
}

// The mean of the chosen rows, of numbers between 0 and 1, with Student's interval of the rows, or of the parts that are independent.
function meanAmong(rows, values, mask) {
  const part = rows.replicate ?? rows.sample, kept = values.filter((_, row) => mask[row]);
  const parts = part && part.filter((_, row) => mask[row]);
  const own = rows.independent ? kept : [], mean = total(kept) / kept.length;
  const estimates = part ? estimatesOf(kept, parts, Boolean(rows.replicate)).estimates : own;
  const count = estimates.length, centre = total(estimates) / count;
  const scatter = total(estimates.map(one => (one - centre) ** 2)) / (count - 1) / count;
  const half = count > 1 && scatter > 0 ? student(rows.students, count - 1) * Math.sqrt(scatter) : NaN;
  return {mean, low: Math.max(mean - half, 0), high: Math.min(mean + half, 1)};
}

function isClear({low, high}, middle) {
  return low > middle || high < middle;
}

// Where the mean rank is not clearly another, the chosen rows may still lie nearer the middle, or farther from it.
function apart(rows, column, mask) {
  const ranks = ranksOf(column), {order, values} = column;
  const median = chosen => {
    const own = order.filter(row => Boolean(mask[row]) === chosen), half = own.length >> 1;
    return own.length % 2 ? values[own[half]] : (values[own[half - 1]] + values[own[half]]) / 2;
  };
  const rank = meanAmong(rows, ranks, mask), away = ranks.map(one => Math.abs(one - 0.5)), middle = total(away) / away.length;
  const distance = meanAmong(rows, away, mask), isAway = !isClear(rank, 0.5) && isClear(distance, middle);
  return {
    column, rank, median: median(true), others: median(false),
    size: isAway ? Math.abs(distance.mean - middle) / 0.5 : Math.abs(rank.mean - 0.5),
    more: isAway ? distance.mean > middle ? "away from the middle" : "near the middle" : isClear(rank, 0.5) ? "" : "not clear",
  };
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
    const found = this.columns.map(one => apart(this.rows, one, mask)).sort((a, b) => b.size - a.size);
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
  const middle = value => make("td", {class: "number"}, data(value, column.words(value, 3)));
  const shifted = cellOf({share: rank.mean, low: rank.low, high: rank.high, more});
  return make("tr", {"data-key": `input/${column.name}`},
    make("th", {scope: "row", title: column.meaning}, ...named(column)), middle(median), middle(others), shifted);
}
