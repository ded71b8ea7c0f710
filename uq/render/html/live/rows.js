// The rows inside the page: columns of numbers, and the state of every row.

function numbersOf(text, Numbers) {
  return new Numbers(Uint8Array.from(atob(text), letter => letter.charCodeAt(0)).buffer);
}

const ENDED = 0, CENSORED = 1, NEVER = 2, UNDEFINED = 3, FAILED = 4;
const STATES = ["", "censored", "never", "undefined", "invalid"];

class Column {
  constructor(plain) {
    Object.assign(this, plain);
    this.values = numbersOf(plain.values, Float64Array);
    this.states = plain.states ? numbersOf(plain.states, Uint8Array) : new Uint8Array(this.values.length);
  }

  // A value in the unit shown, without it.
  digits(value, digits = 4) { return number(value / this.per, digits + this.common); }

  // The same with it, such as "12.3 kN".
  words(value, digits = 4) { return this.digits(value, digits) + this.after; }

  // Two values with it once, such as "1.2 to 12.3 kN".
  between(low, high) { return `${this.digits(low, 3)} to ${this.words(high, 3)}`; }

  wordsOfRow(row) {
    const state = this.states[row], value = this.words(this.values[row], 6);
    if (state === ENDED) return value;
    return state === CENSORED ? `longer than ${value} (censored)` : STATES[state];
  }
}

class Rows {
  constructor(plain) {
    Object.assign(this, plain);
    this.numbers = numbersOf(plain.numbers, Int32Array);
    this.count = this.numbers.length;
    this.columns = plain.columns.map(column => new Column(column));
    this.outputs = this.columns.filter(column => column.role === "output");
    this.categories = plain.categories.map(each => ({...each, places: numbersOf(each.places, Uint8Array)}));
    this.regime = this.categories.find(category => category.name === "regime");
    this.events = plain.events.map(event => ({...event, sides: numbersOf(event.sides, Uint8Array)}));
    this.all = new Float64Array(this.count).fill(1);
  }
}
