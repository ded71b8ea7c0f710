// Which rows are chosen: by categories and by ranges of columns.

class Selection {
  constructor(rows) {
    this.rows = rows;
    this.ranges = new Map(); // column -> [low, high]; an end that is open is infinite
    this.refused = new Map(); // category -> codes that are not shown
    this.listeners = [];
    this.changed = eventually(() => {
      this.update();
      for (const listener of this.listeners) listener();
    });
    this.update();
  }

  get isAll() {
    return this.ranges.size === 0 && [...this.refused.values()].every(codes => codes.size === 0);
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
    const codes = this.refused.get(category) ?? new Set();
    if (!codes.delete(code)) codes.add(code);
    this.refused.set(category, codes);
    this.changed();
  }

  shows(category, code) {
    return !this.refused.get(category)?.has(code);
  }

  clear() {
    this.ranges.clear();
    this.refused.clear();
    this.changed();
  }

  // A life that never ends, or is censored, lies above every finite value.
  update() {
    const mask = new Uint8Array(this.rows.count).fill(1);
    for (const [category, codes] of this.refused) {
      if (codes.size) category.codes.forEach((code, row) => { if (codes.has(code)) mask[row] = 0; });
    }
    for (const [column, [low, high]] of this.ranges) {
      const {values, states} = column;
      for (let row = 0; row < mask.length; row++) {
        const inside = values[row] >= low && (states[row] === CENSORED ? high === Infinity : values[row] <= high);
        if (!inside) mask[row] = 0;
      }
    }
    this.mask = mask;
    this.count = mask.reduce((sum, one) => sum + one, 0);
  }
}
