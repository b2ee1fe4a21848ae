// Answer questions by the page's own scripts: a JSON list on standard input, the answers on standard output.

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const folder = process.argv[2];
const load = (name) => import(pathToFileURL(join(folder, `${name}.js`)).href);
const { band, index, limits, printedLimits } = await load("criterion");
const { among, examine, judgingCommand, place, rangesAt } = await load("dropped_test");
const { unpack } = await load("ellipses");
const { realTransform } = await load("fourier");
const { readTest } = await load("reading");
const { responseMeasures } = await load("response");
const { spline } = await load("spline");
const functions = await load("special_functions");

const { packed, words, questions } = JSON.parse(readFileSync(0, "utf8"));
const ellipses = packed && (await unpack(packed));

const answers = {
  limits: (question) => limits(ellipses, question),
  band: (question) => band(ellipses, question),
  printed: (question) => printedLimits(question),
  index: ({ limits: pair, amplitude, delay }) => index(pair, amplitude, delay),
  special: ({ name, values }) => values.map((value) => functions[name](...value)),
  transform: ({ values, points }) => realTransform(Float64Array.from(values), points).map((part) => [...part]),
  spline: ({ values, places }) => places.map(spline(Float64Array.from(values))),
  read: ({ text }) => { const test = readTest(text, words); return { ...test, command: [...test.command], measured: [...test.measured] }; },
  test: ({ text, threshold }) => place(examine(readTest(text, words)), threshold),
  among: ({ quantities, ranges }) => among(quantities, ranges),
  ranges: ({ structure }) => rangesAt(packed, structure),
  response: ({ values, step, structure }) => responseMeasures(Float64Array.from(values), step, structure),
  command: ({ name, structure, deviations, criterion }) => judgingCommand(name, structure, deviations, criterion),
};

function answer([kind, question]) {
  try {
    return answers[kind](question);
  } catch (error) {
    return { refused: error.message };
  }
}

process.stdout.write(JSON.stringify(questions.map(answer)));
