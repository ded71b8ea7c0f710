// The two sliders of one input: the width of its law, and its place.

function slidersOf(name, reweighting, moved) {
  const column = reweighting.columns.get(name), {kind, plain} = reweighting.old.get(name);
  const other = plain.times && reweighting.columns.get(plain.times).label;
  const more = other ? `, as a multiple of ${other}` : "", label = column.label + more;
  const words = make("output", {class: "range-words"});
  const slider = (what, min, max, step, value) => make("input", {
    type: "range", min, max, step, value, "aria-label": `${label}, ${what}`, "on:input": move,
  });
  const factor = slider("width", 0.2, kind.bounded ? 1 : 1.5, 0.05, 1), shift = slider("shift", -1.5, 1.5, 0.1, 0);

  function move() {
    reweighting.move(name, Number(factor.value), Number(shift.value));
    show();
    moved();
  }

  function wordsOf(key, value) {
    const text = one => other || plain.pure.includes(key) ? number(one) : column.words(one);
    return Array.isArray(value) ? `from ${text(value[0])} to ${text(value.at(-1))}` : `${key} ${text(value)}`;
  }

  function show() {
    const {args} = reweighting.laws.get(name);
    shift.disabled = Boolean(kind.bounded) && Number(factor.value) === 1; // there is no room
    words.textContent = Object.entries(args).filter(([key]) => key !== "counts").map(one => wordsOf(...one)).join(", ");
    factor.setAttribute("aria-valuetext", `${percent(Number(factor.value))} of the width; ${words.textContent}`);
    shift.setAttribute("aria-valuetext", `${number(Number(shift.value))} standard deviations; ${words.textContent}`);
  }

  show();
  const element = make("div", {class: "tolerance", role: "group", "aria-label": label, "data-name": name},
    make("span", {title: column.meaning}, ...named(column), more), words,
    ...(kind.scaleOnly ? [] : [make("label", {}, "width", factor)]), make("label", {}, "shift", shift));
  return {element, reset() { factor.value = 1; shift.value = 0; move(); }};
}
