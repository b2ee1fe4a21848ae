// Axes, curves and marks in SVG. Text is inserted as plain text, so that no content of a file can act as markup.

const NAMESPACE = "http://www.w3.org/2000/svg";

// An SVG element with attributes, and text or children inside.
export function shape(name, attributes = {}, ...inside) {
  const element = document.createElementNS(NAMESPACE, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...inside);
  return element;
}

// An HTML element of a class with text or children inside.
export function node(name, className = "", ...inside) {
  const element = document.createElement(name);
  if (className) element.className = className;
  element.append(...inside);
  return element;
}

// A frame with axes: `x` and `y` are { low, high, label, logarithmic }, sizes in pixels of the drawing.
export class Frame {
  constructor(svg, x, y, { width, height, left = 62, right = 14, top = 12, bottom = 44 }) {
    Object.assign(this, { svg, x, y, left, top, wide: width - left - right, high: height - top - bottom });
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const id = `${svg.id}-clip`;
    const clip = shape("clipPath", { id }, shape("rect", { x: left, y: top, width: this.wide, height: this.high }));
    this.inside = shape("g", { "clip-path": `url(#${id})` });
    const grid = shape("g", { class: "grid" }), labels = shape("g", { class: "ticks" });
    this.#axis(x, grid, labels, true);
    this.#axis(y, grid, labels, false);
    const border = shape("rect", { class: "border", x: left, y: top, width: this.wide, height: this.high });
    svg.replaceChildren(shape("defs", {}, clip), grid, this.inside, border, labels);
  }

  // Place of a value in the drawing.
  across(value) { return this.left + this.wide * share(value, this.x); }

  down(value) { return this.top + this.high * (1 - share(value, this.y)); }

  // Values at a place of the drawing; both axes linear.
  valuesAt(across, down) {
    const value = ({ low, high }, part) => low + (high - low) * part;
    return [value(this.x, (across - this.left) / this.wide), value(this.y, 1 - (down - this.top) / this.high)];
  }

  // Add a curve through pairs of values; pairs that are not finite break it.
  curve(pairs, className) {
    let path = "", pen = "M";
    for (const [x, y] of pairs) {
      const across = this.across(x), down = this.down(y);
      if (!Number.isFinite(across) || !Number.isFinite(down)) { pen = "M"; continue; }
      path += `${pen}${across.toFixed(1)} ${down.toFixed(1)}`;
      pen = "L";
    }
    return this.path(path, className);
  }

  // Add the area between two curves over the same places.
  area(places, low, high, className) {
    const pairs = [...places.map((x, i) => [x, high[i]]), ...places.map((x, i) => [x, low[i]]).reverse()];
    const points = pairs.map(([x, y]) => [this.across(x), this.down(y)]);
    if (!points.flat().every(Number.isFinite)) return null;
    return this.path(`M${points.map((point) => point.map((value) => value.toFixed(1)).join(" ")).join("L")}Z`, className);
  }

  path(d, className) {
    const element = shape("path", { d, class: className });
    this.inside.append(element);
    return element;
  }

  #axis(axis, grid, labels, horizontal) {
    for (const { value, text } of ticks(axis)) {
      const at = horizontal ? this.across(value) : this.down(value), bottom = this.top + this.high;
      grid.append(horizontal
        ? shape("line", { x1: at, x2: at, y1: this.top, y2: bottom })
        : shape("line", { x1: this.left, x2: this.left + this.wide, y1: at, y2: at }));
      labels.append(horizontal
        ? shape("text", { x: at, y: bottom + 16, "text-anchor": "middle" }, text)
        : shape("text", { x: this.left - 7, y: at + 4, "text-anchor": "end" }, text));
    }
    const middle = this.top + this.high / 2;
    labels.append(horizontal
      ? shape("text", { class: "label", x: this.left + this.wide / 2, y: this.top + this.high + 36, "text-anchor": "middle" }, axis.label)
      : shape("text", { class: "label", x: 14, y: middle, transform: `rotate(-90 14 ${middle})`, "text-anchor": "middle" }, axis.label));
  }
}

function share(value, { low, high, logarithmic }) {
  return logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
}

// Round values along an axis with what is written beside them.
function ticks({ low, high, logarithmic }) {
  if (logarithmic) {
    const values = [];
    const dense = Math.log10(high / low) < 2;
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
      for (const digit of dense ? [1, 2, 5] : [1]) values.push(digit * 10 ** power);
    }
    return values.filter((value) => value >= low * 0.999 && value <= high * 1.001)
      .map((value) => ({ value, text: String(Number(value.toPrecision(3))) }));
  }
  const step = roundUp((high - low) / 7), list = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) {
    list.push({ value: k * step, text: String(Number((k * step).toPrecision(6))).replace("-", "\u2212") });
  }
  return list;
}

// The next larger of 1, 2, 5, 10, 20 ...
export function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [1, 2, 5, 10].find((digit) => digit * power >= value * (1 - 1e-9));
}

// Least and greatest of samples in each of so many columns, as places and values of a curve to draw.
export function thinned(values, first, last, columns, at) {
  const pairs = [], width = Math.max((last - first + 1) / columns, 1);
  for (let start = first; start <= last; start += width) {
    const begin = Math.round(start), end = Math.min(Math.max(Math.round(start + width), begin + 1), last + 1);
    let low = begin, high = begin;
    for (let i = begin; i < end; i += 1) {
      if (values[i] < values[low]) low = i;
      if (values[i] > values[high]) high = i;
    }
    for (const i of low < high ? [low, high] : [high, low]) if (i <= last) pairs.push([at(i), values[i]]);
  }
  return pairs;
}
