// Numbers as words, and elements of the page.

const KAPLAN_MEIER = "by Kaplan\u2013Meier, assuming that censoring is non-informative";
const RAISED = "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079";

function number(value, digits = 4) {
  if (!isFinite(value)) return isNaN(value) ? "\u2013" : value > 0 ? "\u221e" : "\u2212\u221e";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 10 ** Math.max(6, digits))) {
    const [mantissa, power] = value.toExponential(digits - 1).split("e");
    const raised = [...String(Number(power))].map(one => RAISED["-0123456789".indexOf(one)]);
    return `${Number(mantissa)}\u00a0\u00d7\u00a010${raised.join("")}`.replace("-", "\u2212");
  }
  return String(Number(value.toPrecision(digits))).replace("-", "\u2212");
}

// A count with its thousands apart.
function grouped(count) {
  return String(count).replace(/\B(?=(\d{3})+$)/g, "\u00a0");
}

function percent(share) {
  if (share === 0 || share === 1) return `${100 * share}\u00a0%`;
  if (share > 0 && share < 0.01) return `${Number((100 * share).toPrecision(2))}\u00a0%`;
  const rest = Number((1 - share).toFixed(12));
  const digits = rest > 0 && rest < 0.001 ? -Math.floor(Math.log10(100 * rest)) : 1;
  return `${(100 * share).toFixed(digits)}\u00a0%`;
}

function capitalized(text) {
  return text.slice(0, 1).toUpperCase() + text.slice(1);
}

// The name of a column with its symbol, every other part of which is an index below the line.
function named({label, symbol = [""]}) {
  const indexed = symbol.map((part, i) => i % 2 ? make("sub", {}, part) : part);
  return symbol[0] ? [`${label} (`, ...indexed, ")"] : [label];
}

// An element with attributes and contents; a name with ":" is an event.
function make(tag, attributes = {}, ...contents) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on:")) element.addEventListener(name.slice(3), value);
    else if (value !== false && value !== undefined) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...contents);
  return element;
}

function draw(tag, attributes, ...contents) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...contents);
  return element;
}

// A dot in the colour of a regime.
function dotOf(colour) {
  return colour ? [make("span", {class: "dot", style: `background:${colour}`})] : [];
}

// A number that a program can read, too.
function data(value, text) {
  return make("data", {value: String(value)}, text);
}

// Call a function once before the next picture, however often it is asked for.
function eventually(work) {
  let waiting = false;
  return () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; work(); });
  };
}
