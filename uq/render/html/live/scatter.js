// Two columns as points: hover, click, brush; arrow keys and Enter for the same.

class Scatter {
  constructor(selection, axes, pick) {
    Object.assign(this, {selection, rows: selection.rows, axes, pick, at: -1, picked: -1});
    this.canvas = make("canvas", {
      tabindex: 0, role: "application", "aria-roledescription": "scatter plot", "aria-describedby": "keys",
    });
    this.brush = make("div", {class: "brush", hidden: true});
    this.tip = make("div", {class: "tip", role: "status", hidden: true});
    this.element = make("div", {class: "scatter"}, this.canvas, this.brush, this.tip);
    this.draw = eventually(() => this.redraw());
    this.listen();
  }

  show(x, y) {
    [this.columnX, this.columnY] = [x, y];
    this.canvas.setAttribute("aria-label", `${y.label} against ${x.label}, one point for each row`);
    this.resize();
  }

  resize() {
    if (!this.columnX) return;
    const width = this.element.clientWidth, height = Math.round(Math.min(440, Math.max(260, 0.62 * width)));
    const ratio = window.devicePixelRatio || 1;
    Object.assign(this.canvas, {width: width * ratio, height: height * ratio});
    this.canvas.style.height = `${height}px`;
    Object.assign(this, {width, height, ratio});
    this.y = new Axis(this.columnY, height - BOTTOM, EDGE);
    this.left = Math.max(LEFT, ...this.y.scale.ticks(5).map(value => LETTER * this.columnY.digits(value).length + 12));
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
    this.drawAxes(pen);
    this.drawPoints(pen, text, style.getPropertyValue("--accent"));
    for (const [row, size] of [[this.at, 5], [this.picked, 7]]) {
      if (row < 0) continue;
      pen.strokeStyle = style.color;
      pen.lineWidth = 2;
      pen.beginPath();
      pen.arc(this.px[row], this.py[row], size, 0, 7);
      pen.stroke();
    }
  }

  drawAxes(pen) {
    const {x, y, width, height, left} = this;
    const bottom = height - BOTTOM;
    pen.textBaseline = "top";
    pen.textAlign = "center";
    let free = 0;
    for (const value of x.scale.ticks(Math.max(2, width / 110))) {
      const at = x.pixel(value), label = x.column.digits(value), half = pen.measureText(label).width / 2;
      pen.strokeRect(at, bottom, 0, TICK);
      if (at - half < free) continue;
      pen.fillText(label, Math.min(at, width - half), bottom + TICK + 3);
      free = at + half + 8;
    }
    for (const [name, at] of x.strips) {
      pen.strokeRect(name === "no value" ? at + STRIP : at, EDGE, 0, bottom - EDGE);
      pen.save();
      pen.translate(at + STRIP - 2, bottom - 4);
      pen.rotate(-Math.PI / 2);
      pen.textAlign = "left";
      pen.textBaseline = "bottom";
      pen.fillText(name, 0, 0);
      pen.restore();
    }
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    for (const value of y.scale.ticks(5)) {
      const at = y.pixel(value);
      pen.strokeRect(left - TICK, at, TICK, 0);
      pen.fillText(y.column.digits(value), left - TICK - 3, at);
    }
    for (const [name, at] of y.strips) {
      const edge = name === "no value" ? at - STRIP : at;
      pen.strokeRect(left, edge, width - EDGE - left, 0);
      pen.fillText(name, left - TICK - 3, at - STRIP / 2);
    }
    pen.strokeRect(left, EDGE, 0, bottom - EDGE);
    pen.strokeRect(left, bottom, width - EDGE - left, 0);
  }

  // Rows that are not chosen lie behind, faint; chosen ones have the colour of their regime.
  drawPoints(pen, faint, accent) {
    const {mask} = this.selection, {regime, count} = this.rows;
    const size = count > 4000 ? 2 : count > 800 ? 3 : count > 60 ? 4 : 7;
    const points = (colour, alpha, shown) => {
      pen.fillStyle = colour;
      pen.globalAlpha = alpha;
      for (let row = 0; row < count; row++) {
        if (shown(row)) pen.fillRect(this.px[row] - size / 2, this.py[row] - size / 2, size, size);
      }
      pen.globalAlpha = 1;
    };
    if (!this.selection.isAll) points(faint, 0.25, row => !mask[row]);
    if (!regime) return points(this.selection.isAll ? this.rows.colours.rows : accent, 0.8, row => mask[row]);
    for (const {code, colour} of regime.entries) points(colour, 0.8, row => mask[row] && regime.codes[row] === code);
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

  point(row) {
    if (row === this.at) return;
    this.at = row;
    this.tip.hidden = row < 0;
    if (row >= 0) {
      const regime = this.rows.regime ? `, ${this.rows.regime.entry(row).label}` : "";
      const lines = [this.columnX, this.columnY].flatMap(one => [
        make("div", {}, `${one.label}:`), make("strong", {}, one.wordsOfRow(row)),
      ]);
      this.tip.replaceChildren(make("div", {}, `Row ${this.rows.numbers[row]}${regime}`), ...lines);
      const right = this.px[row] > this.width / 2;
      this.tip.style.left = right ? "" : `${this.px[row] + 12}px`;
      this.tip.style.right = right ? `${this.width - this.px[row] + 12}px` : "";
      this.tip.style.top = `${Math.max(0, Math.min(this.py[row] - 20, this.height - this.tip.offsetHeight))}px`;
    }
    this.draw();
  }

  open(row, byKey = false) {
    if (row < 0) return;
    this.mark(row);
    this.pick(row, byKey);
  }

  mark(row) {
    this.picked = row;
    this.draw();
  }

  // Back to the row that was open.
  close() {
    const row = this.picked;
    this.picked = -1;
    this.canvas.focus({preventScroll: true});
    this.element.scrollIntoView({block: "nearest"});
    this.point(row);
    this.draw();
  }

  listen() {
    let start = null;
    const place = event => {
      const box = this.canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    const {canvas} = this;
    canvas.addEventListener("pointerdown", event => {
      if (event.button || event.pointerType === "touch") return;
      start = place(event);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", event => {
      const here = place(event);
      if (start && this.stretch(start, here)) this.point(-1);
      else this.point(this.nearest(...here));
    });
    canvas.addEventListener("pointerup", event => {
      const here = place(event);
      if (!start || !this.stretch(start, here)) this.open(this.nearest(...here));
      this.brush.hidden = true;
      start = null;
    });
    canvas.addEventListener("pointercancel", () => { start = null; this.brush.hidden = true; });
    canvas.addEventListener("pointerleave", () => this.point(-1));
    canvas.addEventListener("blur", () => this.point(-1));
    canvas.addEventListener("keydown", event => {
      if (event.key === "Enter" || event.key === " ") this.open(this.at, true);
      else if (!this.step(event.key, event.shiftKey ? 50 : 1)) return;
      event.preventDefault();
    });
    this.selection.listeners.push(() => { this.orders = null; this.draw(); });
  }

  // Brush the rectangle between two places, if it is more than a click.
  stretch(a, b) {
    const [left, right] = [a[0], b[0]].sort((p, q) => p - q), [top, bottom] = [a[1], b[1]].sort((p, q) => p - q);
    if (right - left < 5 && bottom - top < 5) return false;
    Object.assign(this.brush.style, {
      left: `${left}px`, top: `${top}px`, width: `${right - left}px`, height: `${bottom - top}px`,
    });
    this.brush.hidden = false;
    this.selection.setRange(this.columnX, this.x.value(left), this.x.value(right));
    this.selection.setRange(this.columnY, this.y.value(bottom), this.y.value(top));
    return true;
  }

  // Move to the next chosen row in the direction of an arrow.
  step(key, by) {
    const direction = {ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowUp: [1, -1], ArrowDown: [1, 1]}[key];
    if (!direction) return false;
    this.orders ??= [this.px, this.py].map(places => {
      const order = [...places.keys()].filter(row => this.selection.mask[row]);
      return order.sort((a, b) => places[a] - places[b]);
    });
    const order = this.orders[direction[0]], now = order.indexOf(this.at);
    const next = now < 0 ? Math.floor(order.length / 2) : now + by * direction[1];
    if (order.length) this.point(order[Math.max(0, Math.min(order.length - 1, next))]);
    return true;
  }
}
