// The scale of an axis, linear or logarithmic, and its ticks.

class Scale {
  constructor(column) {
    let low = Infinity, high = -Infinity;
    column.values.forEach((value, row) => {
      if (!isFinite(value) || column.states[row] > CENSORED) return;
      if (value < low) low = value;
      if (value > high) high = value;
    });
    if (low > high) [low, high] = [0, 1];
    if (low === high) [low, high] = [low - Math.abs(low || 1) / 2, high + Math.abs(high || 1) / 2];
    this.wide = column.wide && low > 0;
    [this.low, this.high] = [low, high];
    [this.from, this.to] = [this.bent(low), this.bent(high)];
    this.per = column.per;
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

  // About so many round numbers, in the unit shown.
  ticks(count) {
    const least = this.wide ? 1e-300 : -1e300;
    const [low, high] = [this.low, this.high].map(end => Math.min(Math.max(end / this.per, least), 1e300));
    if (this.wide && high / low > 8) {
      const found = [], decades = Math.log10(high) - Math.log10(low);
      const steps = decades > count ? [1] : decades * 2 > count ? [1, 3] : [1, 2, 5];
      for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
        for (const step of steps) {
          const value = step * 10 ** power;
          if (value >= low && value <= high) found.push(value);
        }
      }
      const every = Math.ceil(found.length / (count + 2));
      return found.filter((_, i) => i % every === 0).map(value => value * this.per);
    }
    const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
    const first = step => Math.ceil(low / step), inside = step => Math.max(Math.floor(high / step + 1e-9) - first(step), 0);
    const step = [1, 2, 5, 10].map(one => one * power).find(one => inside(one) <= count + 1);
    return [...new Set(Array.from({length: Math.min(inside(step), 20) + 1}, (_, i) => (first(step) + i) * step * this.per))];
  }
}
