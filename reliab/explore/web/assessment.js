// What the page says of a test: A, d, index, rebuilt error and verdict, as `reliab assess` computes them.

import { brokenChannels, refusal, slowFaults, slowLines, withoutSpikes } from "./faults.js";
import { conclude, prepare, rebuild } from "./rebuilt_error.js";
import { track } from "./tracking.js";

const CERTAIN = 0.95;

// Everything of a test that does not depend on the structure; throws where the test cannot be judged.
export function examine({ command, measured, step, notes, unused }) {
  const bridged = [command, measured].map(withoutSpikes), [x, y] = bridged.map(({ values }) => values);
  const reason = refusal(x, y);
  if (reason) throw new RangeError(reason);
  const count = bridged[0].count + bridged[1].count;
  const spikes = count ? [`Spikes of ${count} samples were replaced by straight lines: no actuator moves like that.`] : [];
  const tracking = track(x, y, step);
  return {
    command: x, measured: y, step, notes: [...notes, ...spikes], unused, broken: brokenChannels(command, measured),
    duration: (command.length - 1) * step, tracking, lines: slowLines(x, y, step, tracking), kept: new Map(),
  };
}

// Judge an examined test for a structure and threshold: value first; `deviations` adds interval and verdict.
export function judge(test, structure, { threshold, metric }) {
  require(test, structure);
  const faults = slowFaults(test.lines, test.measured, { threshold, share: structure.share });
  const without = (chosen) => test.measured.map((value, i) => value - chosen.reduce((sum, fault) => sum + fault.added[i], 0));
  const key = faults.map(({ kind, felt }) => `${kind}${felt}`).join();
  const once = (name, compute) => {
    if (!test.kept.has(name)) test.kept.set(name, compute());
    return test.kept.get(name);
  };
  const tracking = faults.length ? once(`tracking${key}`, () => track(test.command, without(faults), test.step)) : test.tracking;
  const known = faults.some(({ kind }) => kind === "offset") ? 0 : null;
  const rebuiltWithout = (chosen, name) => {
    const prepared = once(name, () => prepare(test.command, without(chosen), test.step));
    const same = ["frequency", "dampingRatio", "share"].every((quantity) => prepared.last?.structure[quantity] === structure[quantity]);
    if (!same) prepared.last = rebuild(prepared, structure, known);
    return prepared.last;
  };
  const unfelt = faults.filter(({ felt }) => felt === false), open = faults.filter(({ felt }) => felt === null);
  return {
    structure, threshold, metric, tracking, faults,
    rebuilt: rebuiltWithout(unfelt, `rebuilt${key}`),
    otherwise: open.map((fault) => () => rebuiltWithout([fault], `without${fault.kind}${key}`)),
  };
}

// Errors with intervals, the probability of staying below the threshold, and the verdict in words. A generator: each
// `yield` is a place where the page may pause.
export function* verdictOf(test, judged, deviations) {
  const errors = yield* conclude(judged.rebuilt, deviations);
  const probability = errors.probability(judged.metric, judged.threshold);
  const word = wordOf(probability), doubts = [...unusedChannels(test.unused), ...(word === "reliable" ? test.broken : [])];
  for (const [i, otherwise] of judged.otherwise.entries()) {
    const changed = (yield* conclude(otherwise(), deviations)).probability(judged.metric, judged.threshold);
    if (wordOf(changed) !== word) {
      const { kind } = judged.faults.filter(({ felt }) => felt === null)[i];
      doubts.push(`Whether the structure felt the ${kind} of the measured displacement is not known, and it decides the verdict.`);
    }
  }
  return { ...errors, probability, word: doubts.length ? "undecided" : word, doubts };
}

// What the page has not looked at: a channel that may contradict the verdict.
function unusedChannels(unused) {
  if (!unused.length) return [];
  return [`The file also holds ${unused.map((part) => `the ${part}`).join(" and ")}, which this page does not use: reliab assess judges the test with ${unused.length > 1 ? "them" : "it"}.`];
}

// Verdict of a probability that the error stays below the threshold.
export function wordOf(probability) {
  if (probability >= CERTAIN) return "reliable";
  return probability <= 1 - CERTAIN ? "not reliable" : "undecided";
}

function require(test, { frequency }) {
  if (test.duration * frequency < 2) throw new RangeError("A test must last at least two periods of the structure.");
  if (frequency * test.step * 10 > 1) throw new RangeError("A period of the structure must hold at least ten samples.");
}
