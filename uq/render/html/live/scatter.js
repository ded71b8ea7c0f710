// Two columns as points: hover, click, brush; arrow keys and Enter for the same.

const ARROWS = {ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowUp: [1, -1], ArrowDown: [1, 1]};

class Scatter {
  constructor(selection, element, pick) {
    Object.assign(this, {selection, element, rows: selection.rows, pick, at: -1, picked: -1});
    [this.canvas, this.brush, this.tip] = element.children;
    this.draw = eventually(() => this.redraw());
    selection.listeners.push(() => { this.orders = null; this.draw(); });
    this.listenToPointer();
    this.listenToKeys();
  }

  show(x, y) {
    [this.columnX, this.columnY] = [x, y];
    this.canvas.setAttribute("aria-label", `${y.label} against ${x.label}, one point for each row`);
    this.resize();
  }

  resize() {
    const width = this.element.clientWidth, height = Math.round(Math.min(440, Math.max(260, 0.62 * width)));
    const ratio = window.devicePixelRatio || 1;
    Object.assign(this.canvas, {width: width * ratio, height: height * ratio});
    this.canvas.style.height = `${height}px`;
    Object.assign(this, {width, height, ratio, bottom: height - BOTTOM});
    this.y = new Axis(this.columnY, this.bottom, EDGE);
    this.left = Math.max(LEFT, ...this.y.scale.ticks.map(value => LETTER * this.columnY.digits(value).length + 12));
    this.x = new Axis(this.columnX, this.left, width - EDGE);
    this.px = Float32Array.from(this.rows.numbers, (_, row) => this.x.pixelOf(row));
    this.py = Float32Array.from(this.rows.numbers, (_, row) => this.y.pixelOf(row));
    this.orders = null;
    this.redraw();
  }

  redraw() {
    const style = getComputedStyle(this.canvas), pen = this.canvas.getContext("2d");
    const text = style.getPropertyValue("--faint"), line = style.getPropertyValue("--line");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    Object.assign(pen, {fillStyle: text, strokeStyle: line, font: `12px ${style.fontFamily}`, lineWidth: 1});
    this.drawHorizontal(pen);
    this.drawVertical(pen);
    this.drawPoints(pen, text, style.getPropertyValue("--accent"));
    Object.assign(pen, {strokeStyle: style.color, lineWidth: 2});
    for (const [row, size] of [[this.at, 5], [this.picked, 7]]) {
      if (row < 0) continue;
      pen.beginPath();
      pen.arc(this.px[row], this.py[row], size, 0, 7);
      pen.stroke();
    }
  }

  drawHorizontal(pen) {
    const {x, left, bottom, width} = this;
    Object.assign(pen, {textBaseline: "top", textAlign: "center"});
    for (const value of x.scale.ticks) {
      const text = x.column.digits(value), most = width - pen.measureText(text).width / 2;
      pen.strokeRect(x.pixel(value), bottom, 0, TICK);
      pen.fillText(text, Math.min(x.pixel(value), most), bottom + TICK + 3);
    }
    Object.assign(pen, {textBaseline: "bottom", textAlign: "left"});
    for (const [name, at] of x.strips) {
      pen.strokeRect(name === "no value" ? at + STRIP : at, EDGE, 0, bottom - EDGE);
      pen.save();
      pen.translate(at + STRIP - 2, bottom - 4);
      pen.rotate(-Math.PI / 2);
      pen.fillText(name, 0, 0);
      pen.restore();
    }
    pen.strokeRect(left, bottom, width - EDGE - left, 0);
  }

  drawVertical(pen) {
    const {y, left, bottom, width} = this;
    Object.assign(pen, {textBaseline: "middle", textAlign: "right"});
    for (const value of y.scale.ticks) {
      pen.strokeRect(left - TICK, y.pixel(value), TICK, 0);
      pen.fillText(y.column.digits(value), left - TICK - 3, y.pixel(value));
    }
    for (const [name, at] of y.strips) {
      pen.strokeRect(left, name === "no value" ? at - STRIP : at, width - EDGE - left, 0);
      pen.fillText(name, left - TICK - 3, at - STRIP / 2);
    }
    pen.strokeRect(left, EDGE, 0, bottom - EDGE);
  }

  // Rows that are not chosen lie behind, faint; chosen ones have the colour of their regime.
  drawPoints(pen, faint, accent) {
    const {selection: {mask, isAll}, rows: {regime, count, colours}} = this;
    const size = count > 4000 ? 2 : count > 800 ? 3 : count > 60 ? 4 : 7;
    const points = (colour, alpha, isShown) => {
      Object.assign(pen, {fillStyle: colour, globalAlpha: alpha});
      for (let row = 0; row < count; row++) {
        if (isShown(row)) pen.fillRect(this.px[row] - size / 2, this.py[row] - size / 2, size, size);
      }
      pen.globalAlpha = 1;
    };
    if (!isAll) points(faint, 0.25, row => !mask[row]);
    if (!regime) return points(isAll ? colours.rows : accent, 0.8, row => mask[row]);
    regime.entries.forEach(({colour}, i) => points(colour, 0.8, row => mask[row] && regime.places[row] === i));
  }

  nearest(x, y) {
    let best = -1, least = 12 ** 2;
    for (let row = 0; row < this.px.length; row++) {
      if (!this.selection.mask[row]) continue;
      const away = (this.px[row] - x) ** 2 + (this.py[row] - y) ** 2;
      if (away < least) [best, least] = [row, away];
    }
    return best;
  }

  // Name a row beside its point; none with -1.
  point(row) {
    if (row === this.at) return;
    this.at = row;
    this.tip.hidden = row < 0;
    this.draw();
    if (row < 0) return;
    const {regime, numbers} = this.rows, columns = [this.columnX, this.columnY];
    const name = `Row ${numbers[row]}${regime ? `, ${regime.entries[regime.places[row]].label}` : ""}`;
    this.tip.textContent = [name, ...columns.map(column => `${column.label}: ${column.wordsOfRow(row)}`)].join("\n");
    const isRight = this.px[row] > this.width / 2, top = Math.min(this.py[row] - 20, this.height - this.tip.offsetHeight);
    const [left, right] = isRight ? [null, this.width - this.px[row] + 12] : [this.px[row] + 12, null];
    place(this.tip, {left, right, top: Math.max(0, top)});
  }

  open(row, byKey = false) { if (row >= 0) this.pick(this.rows.numbers[row], byKey); }

  mark(row) { this.picked = row; this.draw(); }

  // Back to the row that was open.
  close() {
    const row = this.picked;
    this.mark(-1);
    this.canvas.focus({preventScroll: true});
    this.element.scrollIntoView({block: "nearest"});
    this.point(row);
  }

  listenToPointer() {
    let start = null;
    const placeOf = event => [event.offsetX, event.offsetY];
    const done = () => { start = null; this.brush.hidden = true; };
    const on = (name, work) => this.canvas.addEventListener(name, work);
    on("pointerdown", event => {
      if (event.button || event.pointerType === "touch") return;
      start = placeOf(event);
      this.canvas.setPointerCapture(event.pointerId);
    });
    on("pointermove", event => {
      const here = placeOf(event);
      this.point(start && this.stretch(start, here) ? -1 : this.nearest(...here));
    });
    on("pointerup", event => {
      const here = placeOf(event);
      if (!start || !this.stretch(start, here)) this.open(this.nearest(...here));
      done();
    });
    on("pointercancel", done);
    on("pointerleave", () => this.point(-1));
  }

  listenToKeys() {
    this.canvas.addEventListener("blur", () => this.point(-1));
    this.canvas.addEventListener("keydown", event => {
      if (event.key === "Enter" || event.key === " ") this.open(this.at, true);
      else if (event.key in ARROWS) this.step(...ARROWS[event.key], event.shiftKey ? 50 : 1);
      else return;
      event.preventDefault();
    });
  }

  // Brush the rectangle between two places, if it is more than a click.
  stretch(a, b) {
    const [[left, right], [top, bottom]] = [0, 1].map(i => [Math.min(a[i], b[i]), Math.max(a[i], b[i])]);
    if (right - left < 5 && bottom - top < 5) return false;
    place(this.brush, {left, top, width: right - left, height: bottom - top});
    this.brush.hidden = false;
    this.selection.setRange(this.columnX, this.x.value(left), this.x.value(right));
    this.selection.setRange(this.columnY, this.y.value(bottom), this.y.value(top));
    return true;
  }

  // Move to the next chosen row along an axis.
  step(axis, direction, by) {
    this.orders ??= [this.px, this.py].map(places => [...places.keys()]
      .filter(row => this.selection.mask[row]).sort((a, b) => places[a] - places[b]));
    const order = this.orders[axis], now = order.indexOf(this.at);
    const next = now < 0 ? Math.floor(order.length / 2) : now + by * direction;
    if (order.length) this.point(order[Math.max(0, Math.min(order.length - 1, next))]);
  }
}
