// How the inputs of the chosen rows differ from all: how many of them lie in each quarter of all rows.

const HEADS = ["Input", "lowest quarter", "second", "third", "highest quarter"];

// The share of rows in each quarter of a column.
function inQuarters(column, mask, count) {
  column.quarter ??= Uint8Array.from(column.values, value => column.quarters.filter(end => value > end).length);
  const counts = [0, 0, 0, 0];
  column.quarter.forEach((quarter, row) => { counts[quarter] += mask[row]; });
  return counts.map(among => among / count);
}

class Quarters {
  constructor(selection, element) {
    Object.assign(this, {selection, element, rows: selection.rows});
    this.columns = this.rows.columns.filter(column => column.role === "input");
  }

  show() {
    const {isAll, count} = this.selection, {element} = this;
    element.hidden = isAll || !count || count === this.rows.count;
    if (element.hidden) return;
    const lines = this.columns.map(column => this.compared(column)).sort((a, b) => b.size - a.size).map(this.line);
    fill(element.querySelector("table"), HEADS, lines);
  }

  compared(column) {
    const {mask, count} = this.selection, shares = inQuarters(column, mask, count);
    const all = inQuarters(column, this.rows.all, this.rows.count);
    return {column, shares, size: shares.reduce((sum, share, i) => sum + Math.abs(share - all[i]), 0)};
  }

  line({column, shares}) {
    const cells = shares.map(share => cell(share, `${Math.round(100 * share)}\u00a0%`, "", {style: `--share: ${share}`}));
    const head = make("th", {scope: "row", title: column.meaning}, ...named(column));
    return make("tr", {"data-key": `input/${column.name}`}, head, ...cells);
  }
}
