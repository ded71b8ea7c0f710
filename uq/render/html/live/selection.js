// Which rows are chosen: by categories and by ranges of columns.

class Selection {
  constructor(rows) {
    this.rows = rows;
    this.ranges = new Map(); // column -> [low, high]; an end that is open is infinite
    this.refused = new Map(rows.categories.map(category => [category, new Set()])); // codes that are not shown
    this.listeners = [];
    this.changed = eventually(() => {
      this.update();
      for (const listener of this.listeners) listener();
    });
    this.update();
  }

  range(column) {
    return this.ranges.get(column) ?? [-Infinity, Infinity];
  }

  setRange(column, low, high) {
    if (low === -Infinity && high === Infinity) this.ranges.delete(column);
    else this.ranges.set(column, [low, high]);
    this.changed();
  }

  toggle(category, code) {
    const codes = this.refused.get(category);
    if (!codes.delete(code)) codes.add(code);
    this.changed();
  }

  clear() {
    this.ranges.clear();
    for (const codes of this.refused.values()) codes.clear();
    this.changed();
  }

  // A life that never ends, or is censored, lies above every finite value.
  isInside({values, states}, [low, high], row) {
    return values[row] >= low && (states[row] === CENSORED ? high === Infinity : values[row] <= high);
  }

  update() {
    const ranges = [...this.ranges], refused = [...this.refused].filter(([, codes]) => codes.size);
    const isChosen = row => ranges.every(([column, range]) => this.isInside(column, range, row))
      && !refused.some(([category, codes]) => codes.has(category.codes[row]));
    this.isAll = !ranges.length && !refused.length;
    this.mask = Uint8Array.from(this.rows.numbers, (_, row) => Number(isChosen(row)));
    this.count = this.mask.reduce((sum, chosen) => sum + chosen, 0);
  }
}
