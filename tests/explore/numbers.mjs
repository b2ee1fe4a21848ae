// Answer questions by the page's own scripts: a JSON list on standard input, the answers on standard output.

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const folder = process.argv[2];
const load = (name) => import(pathToFileURL(join(folder, `${name}.js`)).href);
const { examine, judge, verdictOf } = await load("assessment");
const { band, index, limits, printedLimits } = await load("criterion");
const { unpack } = await load("ellipses");
const { drawDifferences } = await load("difference_draws");
const { realTransform } = await load("fourier");
const { analyse, synthesise } = await load("lapped_transform");
const { spline } = await load("least_squares");
const { readTest } = await load("reading");
const { roundingStep } = await load("rounding");
const { estimateNoise } = await load("sensor_noise");
const { estimate, probabilityBelow, weightsOf } = await load("spread");
const functions = await load("special_functions");

const { packed, words, questions } = JSON.parse(readFileSync(0, "utf8"));
const ellipses = packed && (await unpack(packed));

const answers = {
  limits: (question) => limits(ellipses, question),
  band: (question) => band(ellipses, question),
  printed: (question) => printedLimits(question),
  index: ({ limits: pair, amplitude, delay }) => index(pair, amplitude, delay),
  special: ({ name, values }) => values.map((value) => functions[name](...value)),
  transform: ({ values }) => realTransform(Float64Array.from(values)).map((part) => [...part]),
  spline: ({ values, places }) => places.map(spline(Float64Array.from(values))),
  read: ({ text }) => { const test = readTest(text, words); return { ...test, command: [...test.command], measured: [...test.measured] }; },
  lapped: ({ values, hop }) => {
    const coefficients = analyse(Float64Array.from(values), hop);
    return { coefficients: coefficients.map((row) => [...row]), history: [...synthesise(coefficients, values.length)] };
  },
  rounding: ({ values }) => roundingStep(Float64Array.from(values)),
  spread: ({ rms, mte }) => Object.fromEntries(Object.entries({ rms, mte }).map(([name, errors]) => {
    const weights = weightsOf(rms), { low, high } = estimate(0.03, errors, weights);
    return [name, { interval: [low, high], probability: probabilityBelow(errors, weights, 0.03) }];
  })),
  draws: ({ command, measured, step, every, frequency, draws }) => {
    const [x, read] = [command, measured].map((values) => Float64Array.from(values)), noise = estimateNoise(x, read, step);
    return finished(drawDifferences({ command: x, read, noise, frequency, every, draws })).map((row) => [...row]);
  },
  test: ({ text, structure, threshold, metric, deviations }) => {
    const test = examine(readTest(text, words)), judged = judge(test, structure, { threshold, metric });
    const { start, error, reference } = judged.rebuilt, verdict = finished(verdictOf(test, judged, deviations ?? {}));
    return {
      ...judged.tracking, start, error: [...error], reference: [...reference],
      rms: { ...verdict.rms, draws: null }, mte: { ...verdict.mte, draws: null },
      probability: verdict.probability, word: verdict.word, doubts: verdict.doubts,
      faults: judged.faults.map(({ kind, felt }) => [kind, felt]),
    };
  },
};

// What a computation in steps returns.
function finished(steps) {
  let step = steps.next();
  while (!step.done) step = steps.next();
  return step.value;
}

function answer([kind, question]) {
  try {
    return answers[kind](question);
  } catch (error) {
    return { refused: error.message };
  }
}

process.stdout.write(JSON.stringify(questions.map(answer)));
