// Axes: their scales, and where the points of a column lie, on an axis or on a margin for each state without a value.

class Scale {
  constructor({axis}) {
    Object.assign(this, axis);
    [this.from, this.to] = [this.bent(this.low), this.bent(this.high)];
  }

  bent(value) { return this.wide ? Math.log(value) : value; }

  // The place of a value on the axis: 0 at its lower, 1 at its upper end.
  place(value) { return (this.bent(value) - this.from) / (this.to - this.from); }

  // The value at a place; the ends exactly.
  value(place) {
    if (place <= 0) return this.low;
    if (place >= 1) return this.high;
    const bent = this.from + place * (this.to - this.from);
    return this.wide ? Math.exp(bent) : bent;
  }
}

const LEFT = 62, BOTTOM = 26, EDGE = 8, STRIP = 20, TICK = 4, LETTER = 7, MARGIN = 6; // pixels

// From one pixel to another.
class Axis {
  constructor(column, from, to) {
    this.column = column;
    this.scale = new Scale(column);
    const sign = Math.sign(to - from), seen = new Set(column.states);
    this.strips = new Map();
    if (seen.has(UNDEFINED) || seen.has(FAILED)) {
      this.strips.set("no value", from);
      from += sign * STRIP;
    }
    for (const [state, name] of [[NEVER, "never"], [CENSORED, "censored"]]) {
      if (!seen.has(state)) continue;
      to -= sign * STRIP;
      this.strips.set(name, to);
    }
    [this.from, this.to, this.sign] = [from + sign * MARGIN, to - sign * MARGIN, sign]; // whole points at the ends
  }

  pixel(value) { return this.from + this.scale.place(value) * (this.to - this.from); }

  // Points of a strip are spread over its width.
  pixelOf(row) {
    const state = this.column.states[row];
    if (state === ENDED) return this.pixel(this.column.values[row]);
    const start = this.strips.get(state >= UNDEFINED ? "no value" : STATES[state]);
    return start + this.sign * STRIP * (0.2 + 0.6 * ((row * 0.6180339887) % 1));
  }

  // The value at a pixel; infinite beyond the ends.
  value(pixel) {
    const place = (pixel - this.from) / (this.to - this.from);
    return place <= 0 ? -Infinity : place >= 1 ? Infinity : this.scale.value(place);
  }
}
