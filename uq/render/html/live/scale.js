// The scale of an axis, linear or logarithmic.

class Scale {
  constructor({axis}) {
    Object.assign(this, axis);
    [this.from, this.to] = [this.bent(this.low), this.bent(this.high)];
  }

  bent(value) { return this.wide ? Math.log(value) : value; }

  // The place of a value on the axis: 0 at its lower, 1 at its upper end.
  place(value) { return (this.bent(value) - this.from) / (this.to - this.from); }

  has(value) { return value >= this.low && value <= this.high; }

  // The value at a place; the ends exactly.
  value(place) {
    if (place <= 0) return this.low;
    if (place >= 1) return this.high;
    const bent = this.from + place * (this.to - this.from);
    return this.wide ? Math.exp(bent) : bent;
  }
}
