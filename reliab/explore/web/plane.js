// The plane of amplitude A and delay d: the motions' boundaries, the tolerable region, and a probe.

import { index } from "./criterion.js";
import { Frame, roundUp, shape } from "./drawing.js";

const SIZE = { width: 520, height: 430 };

// Draw regions: limits [a, b] by side of the criterion, of the motions, of the band and of what is compared.
export function drawPlane(svg, { own, motions, band, compared }) {
  const reach = [0, 1].map((k) => {
    const regions = [...Object.values(own), ...Object.values(compared ?? {})].map((pair) => Math.sqrt(pair[k]));
    const ordered = motions.lag.map((pair) => Math.sqrt(pair[k])).filter(Number.isFinite).sort((p, q) => p - q);
    return Math.max(...regions) || ordered[ordered.length >> 1];
  });
  const [x, y] = reach.map((value) => roundUp(1.15 * 1.9 * value));
  const frame = new Frame(svg,
    { low: -100 * x, high: 100 * x, label: "Amplitude error A \u2212 1 [%]" },
    { low: -y, high: y, label: "Delay d [ms]; a lead is negative" }, SIZE);
  frame.path(Object.entries(motions).map(([side, pairs]) => pairs.map((pair) => half(frame, pair, side)).join("")).join(""), "motions");
  if (band) {
    for (const place of [0, 1]) frame.path(outline(frame, sideBySide(band, place)), "band-edge");
  }
  frame.path(outline(frame, own), "region");
  if (compared) frame.path(outline(frame, compared), "compared");
  frame.inside.append(
    shape("line", { class: "zero", x1: frame.across(0), x2: frame.across(0), y1: frame.down(-y), y2: frame.down(y) }),
    shape("line", { class: "zero", x1: frame.across(-100 * x), x2: frame.across(100 * x), y1: frame.down(0), y2: frame.down(0) }));
  return frame;
}

// Mark the probe at A [-] and d [s].
export function drawProbe(frame, amplitude, delay) {
  frame.svg.querySelector(".probe")?.remove();
  frame.inside.append(shape("circle", { class: "probe", cx: frame.across(100 * (amplitude - 1)), cy: frame.down(1e3 * delay), r: 5 }));
}

// Index of a place in the plane, and how many motions' own ellipses hold it, in words.
export function describePlace({ own, motions }, amplitude, delay) {
  const side = delay < 0 && own.lead ? "lead" : "lag", value = index(own[side], amplitude, delay);
  const holding = motions[side].filter((pair) => index(pair, amplitude, delay) <= 1).length;
  const known = motions[side].filter(([a, b]) => Number.isFinite(a) && Number.isFinite(b)).length;
  return `A = ${amplitude.toFixed(4)}, d = ${(1e3 * delay).toFixed(3)} ms: index ${value.toPrecision(3)}, ` +
    `${value <= 1 ? "accepted" : "not accepted"}; inside the boundaries of ${holding} of ${known} motions.`;
}

function sideBySide(band, place) {
  return Object.fromEntries(Object.entries(band).map(([side, pairs]) => [side, pairs.map((pair) => pair[place])]));
}

// Both halves of a region as one closed outline.
function outline(frame, limits) {
  return Object.entries(limits).map(([side, pair]) => half(frame, pair, side)).join("");
}

// Half an ellipse: above the axis for lags, below for leads.
function half(frame, [a, b], side) {
  if (!(a > 0 && b > 0)) return "";
  const rx = frame.across(100 * Math.sqrt(a)) - frame.across(0), ry = frame.down(0) - frame.down(Math.sqrt(b));
  const [x, y] = [frame.across(0), frame.down(0)];
  return `M${(x - rx).toFixed(1)} ${y}A${rx.toFixed(1)} ${ry.toFixed(1)} 0 0 ${side === "lead" ? 0 : 1} ${(x + rx).toFixed(1)} ${y}`;
}
