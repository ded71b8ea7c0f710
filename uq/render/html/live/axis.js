// Where the points of a column lie: on an axis, or on a margin for each state without a value.

const LEFT = 62, BOTTOM = 26, EDGE = 8, STRIP = 20, TICK = 4, LETTER = 7, MARGIN = 6; // pixels
const MARGINS = [[NEVER, "never"], [CENSORED, "censored"]]; // beyond the upper end of an axis

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
    for (const [state, name] of MARGINS) {
      if (!seen.has(state)) continue;
      to -= sign * STRIP;
      this.strips.set(name, to);
    }
    [this.from, this.to, this.sign] = [from + sign * MARGIN, to - sign * MARGIN, sign]; // whole points at the ends
  }

  pixel(value) {
    return this.from + this.scale.place(value) * (this.to - this.from);
  }

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

// The labels of ticks along a line that leave room for each other.
function withRoom(column, scale, pixel, width, end) {
  const labels = [];
  let free = -Infinity;
  for (const value of scale.ticks) {
    const text = column.digits(value), half = width(text) / 2, at = Math.min(pixel(value), end - half);
    if (at - half < free) continue;
    labels.push({text, at});
    free = at + half + 8;
  }
  return labels;
}
