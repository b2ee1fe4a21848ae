// Answer questions by the page's own scripts: a JSON list on standard input, the answers on standard output.

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const folder = process.argv[2];
const load = (name) => import(pathToFileURL(join(folder, `${name}.js`)).href);
const { band, index, limits, printedLimits } = await load("criterion");
const { judgingCommand } = await load("command");
const { unpack } = await load("ellipses");
const functions = await load("special_functions");

const { packed, questions } = JSON.parse(readFileSync(0, "utf8"));
const ellipses = packed && (await unpack(packed));

const answers = {
  limits: (question) => limits(ellipses, question),
  band: (question) => band(ellipses, question),
  printed: (question) => printedLimits(question),
  index: ({ limits: pair, amplitude, delay }) => index(pair, amplitude, delay),
  special: ({ name, values }) => values.map((value) => functions[name](...value)),
  command: ({ structure, deviations, criterion }) => judgingCommand(structure, deviations, criterion),
};

function answer([kind, question]) {
  try {
    return answers[kind](question);
  } catch (error) {
    return { refused: error.message };
  }
}

process.stdout.write(JSON.stringify(questions.map(answer)));
