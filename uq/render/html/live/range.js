// Two handles that choose a range of a column, by pointer or keyboard.

const STEPS = 500;

class Range {
  constructor(selection, column, element) {
    Object.assign(this, {selection, column, element, scale: new Scale(column)});
    this.handles = [...element.querySelectorAll("input")];
    this.handles.forEach((handle, end) => handle.addEventListener("input", () => this.move(end)));
  }

  move(end) {
    const [low, high] = this.handles;
    if (Number(low.value) > Number(high.value)) this.handles[end].value = this.handles[1 - end].value;
    const [from, to] = [Number(low.value), Number(high.value)];
    this.selection.setRange(this.column, from === 0 ? -Infinity : this.scale.value(from / STEPS),
      to === STEPS ? Infinity : this.scale.value(to / STEPS));
  }

  show() {
    const {column, scale, element} = this, ends = this.selection.range(column);
    this.handles.forEach((handle, end) => {
      const place = isFinite(ends[end]) ? Math.min(Math.max(scale.place(ends[end]), 0), 1) : end;
      handle.value = STEPS * place;
      handle.setAttribute("aria-valuetext", isFinite(ends[end]) ? column.words(ends[end]) : "open");
      element.querySelector(".track").style.setProperty(["--from", "--to"][end], place);
    });
    [element.dataset.low, element.dataset.high] = ends;
    const [low, high] = [scale.low, scale.high].map((limit, end) => isFinite(ends[end]) ? ends[end] : limit);
    element.querySelector("output").textContent = column.between(low, high);
  }
}
