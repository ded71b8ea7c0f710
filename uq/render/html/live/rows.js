// The rows inside the page: columns of numbers, and what is known of every row.

function numbersOf(text, Numbers) {
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = characters.charCodeAt(i);
  return new Numbers(bytes.buffer);
}

const ENDED = 0, CENSORED = 1, NEVER = 2, UNDEFINED = 3, FAILED = 4;
const STATES = ["", "censored", "never", "undefined", "failed"];

class Column {
  constructor(plain, failed) {
    Object.assign(this, plain);
    this.values = numbersOf(plain.values, Float64Array);
    const censored = plain.censored ? numbersOf(plain.censored, Uint8Array) : null;
    this.states = this.values.map((value, row) => {
      if (isNaN(value)) return failed[row] ? FAILED : UNDEFINED;
      if (censored && censored[row]) return CENSORED;
      return value === Infinity ? NEVER : ENDED;
    });
  }

  // The same with a value in the rows that failed.
  withFailedAt(value) {
    const state = value === Infinity ? NEVER : ENDED, at = this.states.map(one => one === FAILED);
    return Object.assign(Object.create(this), {
      values: this.values.map((one, row) => at[row] ? value : one),
      states: this.states.map((one, row) => at[row] ? state : one),
    });
  }

  // Digits that the values of all rows have in common.
  get common() {
    if (this.alike === undefined) {
      let low = Infinity, high = -Infinity;
      this.values.forEach((value, row) => {
        if (!isFinite(value) || this.states[row] > CENSORED) return;
        low = Math.min(low, value);
        high = Math.max(high, value);
      });
      const alike = high > low ? Math.floor(Math.log10(Math.max(-low, high)) - Math.log10(high - low)) : 0;
      this.alike = Math.min(Math.max(alike, 0), 13);
    }
    return this.alike;
  }

  // What its curve shows, and its quantiles.
  get curveName() {
    if (this.success) return "Share that has not yet succeeded";
    return this.life ? "Share that outlives each time" : "Share above each value";
  }

  quantileName(probability) {
    if (probability === 0.5) return "median";
    return this.life && !this.success ? `B${100 * probability}` : `${100 * probability}\u00a0% quantile`;
  }

  // A value in the unit shown, without it.
  digits(value, digits = 4) {
    return number(value / this.per, digits + this.common);
  }

  // The same with it, such as "12.3 kN".
  words(value, digits = 4) {
    return this.digits(value, digits) + this.afterNumber;
  }

  // Two values with it once, such as "1.2 to 12.3 kN".
  between(low, high, digits) {
    return `${this.digits(low, digits)} to ${this.words(high, digits)}`;
  }

  get afterNumber() {
    if (!this.unit || this.unit === "\u00b0") return this.unit;
    return `${this.unit.startsWith("10") ? "\u00a0\u00d7\u00a0" : " "}${this.unit}`; // a unit such as 10⁻¹⁵ m²
  }

  wordsOfRow(row) {
    const state = this.states[row], value = this.words(this.values[row], 6);
    if (state === ENDED) return value;
    return state === CENSORED ? `longer than ${value} (censored)` : STATES[state];
  }

  // Whether each row lies on the side of a threshold that the study asks about; NaN if unknown.
  hits(threshold) {
    return this.values.map((value, row) => {
      const state = this.states[row];
      if (state === FAILED) return NaN;
      if (state === UNDEFINED) return 0;
      if (state === CENSORED && value < threshold) return NaN;
      if (this.life) return state !== CENSORED && value < threshold ? 1 : 0;
      return (this.angle ? Math.abs(value) : value) > threshold ? 1 : 0;
    });
  }

  // The rows that have a value, ascending.
  get order() {
    return this.ascending ??= [...this.states.keys()].filter(row => this.states[row] < UNDEFINED)
      .sort((a, b) => this.values[a] - this.values[b] || this.states[a] - this.states[b]);
  }

  // In plain text, where no index of a symbol can stand below the line.
  get title() {
    const [symbol, ...more] = this.symbol ?? [], name = symbol && !more.length ? `${this.label} (${symbol})` : this.label;
    return this.unit ? `${name} [${this.unit}]` : name;
  }
}

class Category {
  constructor(plain) {
    Object.assign(this, plain);
    this.codes = numbersOf(plain.codes, Int8Array);
    this.places = new Map(this.entries.map((entry, place) => [entry.code, place]));
  }

  entry(row) {
    return this.entries[this.places.get(this.codes[row])];
  }
}

class Rows {
  constructor(plain) {
    Object.assign(this, plain);
    this.numbers = numbersOf(plain.numbers, Int32Array);
    this.failed = numbersOf(plain.failed, Uint8Array);
    this.replicate = plain.replicate ? numbersOf(plain.replicate, Int32Array) : null;
    this.samples ??= null;
    this.sample = plain.sample ? numbersOf(plain.sample, Int32Array) : null;
    this.columns = plain.columns.map(one => new Column(one, this.failed));
    this.categories = plain.categories.map(one => new Category(one));
  }

  get count() {
    return this.numbers.length;
  }

  get regime() {
    return this.categories.find(one => one.name === "regime");
  }
}
