// The command that judges a test of the structure with the criterion of the sliders, to be copied.

const field = (id) => document.getElementById(id);

export function judgingCommand({ frequency, dampingRatio, share }, deviations, { threshold, confidence, metric }) {
  const stated = (value, deviation) => (deviation > 0 ? `${value}±${Number((value * deviation).toPrecision(3))}` : String(value));
  const options = [["f", stated(frequency, deviations.frequency)], ["xi", stated(dampingRatio, deviations.dampingRatio)]];
  if (share !== 1) options.push(["alpha", share]);
  if (threshold !== 0.05) options.push(["threshold", threshold]);
  if (confidence !== 0.95) options.push(["confidence", confidence]);
  if (metric !== "rms") options.push(["metric", metric]);
  return ["reliab assess TEST.csv", ...options.map(([option, value]) => `--${option} ${value}`)].join(" ");
}

// Copy the command; selected, too, where the browser does not let a page write to the clipboard.
export function copyCommand() {
  getSelection().selectAllChildren(field("command"));
  navigator.clipboard?.writeText(field("command").textContent).catch(() => {});
}
