// Histories of a test: command and measured displacement.

import { Frame, thinned } from "./drawing.js";

const SIZE = { width: 980, height: 250, bottom: 40 };
const COLUMNS = 900;

// Draw the part of a test from one time to another [s]; returns the frame.
export function drawHistories(svg, { command, measured, step }, [from, to]) {
  const first = Math.max(Math.floor(from / step), 0), end = Math.min(Math.ceil(to / step), command.length - 1);
  const curves = [command, measured].map((values) => thinned(values, first, end, COLUMNS, (i) => i * step).map(([time, x]) => [time, 1e3 * x]));
  const top = 1.08 * curves.flat().reduce((most, [, x]) => Math.max(most, Math.abs(x)), 1e-9);
  const frame = new Frame(svg, { low: first * step, high: end * step, label: "Time [s]" }, { low: -top, high: top, label: "Displacement [mm]" }, SIZE);
  curves.forEach((curve, k) => frame.curve(curve, ["command", "measured"][k]));
  return frame;
}
