// Histories of a test: command, measured displacement and exact response, and the rebuilt error below.

import { Frame, thinned } from "./drawing.js";

const SIZE = { width: 980, height: 250, bottom: 40 };
const COLUMNS = 900;

// Draw the part of a test from one time to another [s]; returns the frames.
export function drawHistories({ motion, error }, { command, measured, reference, strayed, step, bound }, [from, to]) {
  const last = command.length - 1;
  const first = Math.max(Math.floor(from / step), 0), end = Math.min(Math.ceil(to / step), last);
  const time = (i) => i * step, pairs = (values) => thinned(values, first, end, COLUMNS, time).map(([t, x]) => [t, 1e3 * x]);
  const axis = { low: first * step, high: end * step, label: "Time [s]" };
  const curves = [pairs(command), pairs(measured), pairs(reference)];
  const reach = (lists) => 1.08 * lists.flat().reduce((most, [, x]) => Math.max(most, Math.abs(x)), 1e-9);
  const top = reach(curves), strayedPairs = pairs(strayed), below = Math.max(reach([strayedPairs]), 1.1e3 * bound);
  const upper = new Frame(motion, axis, { low: -top, high: top, label: "Displacement [mm]" }, SIZE);
  curves.forEach((curve, k) => upper.curve(curve, ["command", "measured", "reference"][k]));
  const lower = new Frame(error, axis, { low: -below, high: below, label: "x\u2098 \u2212 x\u1d62 [mm]" }, SIZE);
  lower.curve(strayedPairs, "error");
  for (const sign of [-1, 1]) lower.curve([[axis.low, sign * 1e3 * bound], [axis.high, sign * 1e3 * bound]], "bound");
  return { upper, lower };
}
