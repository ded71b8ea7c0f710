// Numbers as words, and elements of the page.

const RAISED = "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079";

function number(value, digits = 4) {
  if (!isFinite(value)) return isNaN(value) ? "\u2013" : value > 0 ? "\u221e" : "\u2212\u221e";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 10 ** Math.max(6, digits))) {
    const [mantissa, power] = value.toExponential(digits - 1).split("e");
    const raised = [...String(Number(power))].map(sign => RAISED["-0123456789".indexOf(sign)]);
    return `${Number(mantissa)}\u00a0\u00d7\u00a010${raised.join("")}`.replace("-", "\u2212");
  }
  return String(Number(value.toPrecision(digits))).replace("-", "\u2212");
}

// A count with its thousands apart.
function grouped(count) {
  return String(count).replace(/\B(?=(\d{3})+$)/g, "\u00a0");
}

function percent(share) {
  if (isNaN(share)) return "\u2013";
  if (share === 0 || share === 1) return `${100 * share}\u00a0%`;
  if (share < 0.01) return `${Number((100 * share).toPrecision(2))}\u00a0%`;
  const rest = Number((1 - share).toFixed(12));
  const digits = rest > 0 && rest < 0.001 ? -Math.floor(Math.log10(100 * rest)) : 1;
  return `${(100 * share).toFixed(digits)}\u00a0%`;
}

// The name of a column with its symbol, every other part of which is an index below the line.
function named({label, symbol = [""]}) {
  const indexed = symbol.map((part, i) => i % 2 ? make("sub", {}, part) : part);
  return symbol[0] ? [`${label} (`, ...indexed, ")"] : [label];
}

const DRAWN = ["svg", "path", "line", "text"];

// An element with attributes and contents; a name with ":" is an event.
function make(tag, attributes = {}, ...contents) {
  const element = DRAWN.includes(tag)
    ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on:")) element.addEventListener(name.slice(3), value);
    else if (value !== false && value !== undefined) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...contents);
  return element;
}

// Fill a table: heads of its columns, and its lines.
function fill(table, heads, lines) {
  const head = make("tr", {}, ...heads.map(text => text ? make("th", {scope: "col"}, text) : make("td")));
  table.replaceChildren(make("thead", {}, head), make("tbody", {}, ...lines));
}

// A cell with a number that a program can read, too, and small print.
function cell(value, text, more = "", attributes = {}) {
  const small = more ? [make("small", {}, more)] : [];
  return make("td", {class: "number", ...attributes}, make("data", {value: String(value)}, text), ...small);
}

// Place an element, in pixels.
function place(element, box) {
  for (const [name, pixels] of Object.entries(box)) element.style[name] = pixels === null ? "" : `${pixels}px`;
}

// A button that copies a text, and the place where it says so.
function copyButton(text) {
  const done = make("span", {role: "status"});
  const isCopied = () => { done.textContent = "Copied"; setTimeout(() => { done.textContent = ""; }, 2000); };
  const isRefused = () => { done.textContent = "Select the command to copy it."; };
  const copy = async () => navigator.clipboard.writeText(text());
  return [make("button", {type: "button", "on:click": () => copy().then(isCopied, isRefused)}, "Copy"), done];
}

// Call a function once before the next picture, however often it is asked for.
function eventually(work) {
  let waiting = null;
  const go = () => { waiting = null; work(); };
  return () => { waiting ??= requestAnimationFrame(go); };
}
