// Two handles that choose a range of a column, by pointer or keyboard.

const STEPS = 500;

function rangeOf(selection, column) {
  const scale = new Scale(column);
  const handle = (name, value, end) => make("input", {
    type: "range", min: 0, max: STEPS, value, "aria-label": `${column.label}, ${name}`, "on:input": () => moved(end),
  });
  const low = handle("from", 0, 0), high = handle("to", STEPS, 1);
  const shown = make("output", {class: "range-words"});
  const track = make("div", {class: "track"}, make("div", {class: "between"}), low, high);
  const element = make("div", {class: "range", "data-name": column.name, role: "group", "aria-label": `Range of ${column.label}`},
    make("span", {title: column.meaning}, ...named(column)), track, shown);

  function moved(end) {
    if (Number(low.value) > Number(high.value)) (end ? high : low).value = (end ? low : high).value;
    const [a, b] = [Number(low.value), Number(high.value)];
    selection.setRange(column, a === 0 ? -Infinity : scale.value(a / STEPS),
      b === STEPS ? Infinity : scale.value(b / STEPS));
  }

  function show() {
    const [a, b] = selection.range(column);
    const place = (value, open) => isFinite(value) ? Math.min(Math.max(scale.place(value), 0), 1) : open;
    const [from, to] = [place(a, 0), place(b, 1)];
    low.value = STEPS * from;
    high.value = STEPS * to;
    low.setAttribute("aria-valuetext", isFinite(a) ? column.words(a) : "open");
    high.setAttribute("aria-valuetext", isFinite(b) ? column.words(b) : "open");
    track.style.setProperty("--from", from);
    track.style.setProperty("--to", to);
    [element.dataset.low, element.dataset.high] = [a, b];
    shown.textContent = column.between(isFinite(a) ? a : scale.low, isFinite(b) ? b : scale.high, 3);
  }
  return {element, show};
}
