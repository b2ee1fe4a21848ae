// Tolerable delay and amplitude error over natural frequency: the criterion, its band, and 90 % of the motions.

import { Frame } from "./drawing.js";

const SIZE = { width: 520, height: 220, bottom: 42 };

// Draw one quantity: `k` is 0 for the amplitude error [%] and 1 for the delay [ms]; rows are frequencies.
export function drawOverFrequency(svg, k, rows, frequency) {
  const factor = k === 0 ? 100 : 1, value = (limit) => factor * Math.sqrt(limit);
  const places = rows.map((row) => row.frequency);
  const line = rows.map((row) => value(row.limits[k]));
  const spread = rows.map((row) => row.motions[k].map(value));
  const compared = rows.map((row) => (row.compared ? value(row.compared[k]) : NaN));
  const all = [...line, ...spread.flat(), ...compared].filter((x) => Number.isFinite(x) && x > 0);
  if (all.length === 0) { svg.replaceChildren(); return; }
  const ends = { low: Math.min(...places), high: Math.max(...places) };
  const frame = new Frame(svg,
    { ...ends, low: ends.low === ends.high ? ends.low / 2 : ends.low, label: "Natural frequency f [Hz]" },
    { low: Math.min(...all) / 1.15, high: Math.max(...all) * 1.15, logarithmic: true, label: k === 0 ? "|A \u2212 1| [%]" : "Delay [ms]" }, SIZE);
  frame.area(places, spread.map(([low]) => low), spread.map(([, high]) => high), "spread");
  if (rows.every((row) => row.band)) {
    const band = rows.map((row) => row.band[k].map(value));
    frame.area(places, band.map(([low]) => low), band.map(([, high]) => high), "band");
  }
  frame.curve(places.map((x, i) => [x, line[i]]), "line");
  frame.curve(places.map((x, i) => [x, compared[i]]), "compared");
  frame.curve([[frequency, frame.y.low], [frequency, frame.y.high]], "here");
}
