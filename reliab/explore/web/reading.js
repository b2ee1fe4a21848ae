// Read a test from text in columns: time, command and measured displacement, named or in this order.
//
// Plain texts only, with names and units of `reliab assess` (`words`, written into the page by Python): of any
// other file `reliab record` writes one that the page reads.

import { median } from "./fourier.js";

const COMMENT = /^(#|%|\/\/|!)/;
const MISSING = new Set(["", "nan", "na", "n/a", "null", "none", "-nan", "#n/a"]);
const DECIMAL_COMMA = /^[+-]?\d+,\d+(?:[eE][+-]?\d+)?$/;
const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$/;
const UNIT = /[[(]\s*([^\])]+?)\s*[\])]\s*$|(?<=[a-z0-9])_([a-zµ]+(?:\/s(?:\^?2|²)|ps2|s2)?)$/i;
const FEWEST_SAMPLES = 64;
const MOST_SAMPLES = 2_000_000;

const ELSEWHERE = "`reliab record FILE --csv TEST.csv` writes a file that this page reads, from MATLAB, HDF5, TDMS and any text.";

// A reason why a file cannot be read, in a sentence for its user.
export class ReadingError extends Error {}

// Command and measured displacement [m], step [s], and sentences about what was assumed.
export function readTest(text, words) {
  const { rows, names, units } = tableOf(text);
  const places = recognise(names, rows[0].length, words), notes = [];
  const column = (part) => Float64Array.from(rows, (row) => row[places[part]]);
  const unit = (part) => {
    const stated = names ? units[places[part]] || unitOf(names[places[part]], words) : "";
    return Object.hasOwn(part === "time" ? words.times : words.lengths, stated) ? stated : "";
  };
  const lengths = ["command", "measured"].map(unit);
  if (!names) notes.push("The columns have no names and were taken by their order.");
  if (lengths[0] === "" && lengths[1] === "") notes.push("No unit is stated: displacements were taken to be in metres.");
  const metres = lengths.map((length, i) => words.lengths[length || lengths[1 - i]] ?? 1);
  const step = stepOf(column("time")) * (words.times[unit("time")] ?? 1);
  const scaled = (part, factor) => column(part).map((value) => value * factor);
  return { command: scaled("command", metres[0]), measured: scaled("measured", metres[1]), step, notes };
}

// Rows of numbers, with the names and units of the columns where lines before them state them.
function tableOf(text) {
  const lines = text.replace(/^\uFEFF/, "").split(/\r\n|\r|\n/)
    .map((line, i) => ({ line, number: i + 1 }))
    .filter(({ line }) => line.trim() !== "" && !COMMENT.test(line.trim()));
  const separator = [";", "\t", ",", /\s+/].find((candidate) => lines.slice(0, 500).some(({ line }) => holdsNumbers(cellsOf(line, candidate))));
  if (separator === undefined) throw new ReadingError(`The file must hold rows of numbers: time, command and measured displacement. ${ELSEWHERE}`);
  const cells = lines.map(({ line }) => cellsOf(line, separator));
  const first = cells.findIndex(holdsNumbers), width = cells[first].length;
  if (lines.length - first > MOST_SAMPLES) throw new ReadingError(`The file has more than ${MOST_SAMPLES} rows; use reliab assess.`);
  const header = cells.slice(0, first).filter((row) => row.length === width).slice(-2);
  const rows = cells.slice(first).map((row, i) => numbersOf(row, width, lines[first + i].number));
  if (rows.length < FEWEST_SAMPLES) throw new ReadingError(`A test must have at least ${FEWEST_SAMPLES} samples; this has ${rows.length}.`);
  const units = (header[1] ?? Array(width).fill("")).map((cell) => cell.replace(/^[[(]+|[\])]+$/g, "").toLowerCase());
  return { rows, names: header[0] ?? null, units };
}

function cellsOf(line, separator) {
  return (separator instanceof RegExp ? line.trim() : line).split(separator)
    .map((cell) => cell.trim().replace(/^"|"$/g, "").trim());
}

function holdsNumbers(cells) {
  const numbers = cells.map(numberOf);
  return cells.length > 1 && !numbers.includes(null) && numbers.some(Number.isFinite);
}

function numberOf(cell) {
  if (NUMBER.test(cell)) return Number(cell);
  if (MISSING.has(cell.toLowerCase())) return NaN;
  return DECIMAL_COMMA.test(cell) ? Number(cell.replace(",", ".")) : null;
}

function numbersOf(cells, width, line) {
  if (cells.length !== width) throw new ReadingError(`Line ${line} has ${cells.length} columns; the first row has ${width}. ${ELSEWHERE}`);
  return cells.map((cell) => {
    const number = numberOf(cell);
    if (number === null || !Number.isFinite(number)) throw new ReadingError(`Line ${line}: every value must be a finite number. ${ELSEWHERE}`);
    return number;
  });
}

// Place of time, command and measured displacement among the columns.
function recognise(names, width, words) {
  if (names === null) {
    if (width !== 3) throw new ReadingError(`Columns without names must be time, command and measured; this file has ${width}. ${ELSEWHERE}`);
    return { time: 0, command: 1, measured: 2 };
  }
  const plain = names.map((name) => normal(name, words)), places = {};
  for (const part of ["time", "command", "measured"]) {
    const matches = plain.flatMap((name, i) => (words.names[part].includes(name) ? [i] : []));
    const loose = matches.length ? matches : names.flatMap((name, i) => (wordsOf(name, words).some((word) => words.names[part].includes(word)) ? [i] : []));
    if (loose.length !== 1) {
      const what = loose.length ? "More than one column may be" : "No column is named as";
      throw new ReadingError(`${what} the ${part}${part === "time" ? "" : " displacement"}: name the columns time_s, command_m and measured_m. ${ELSEWHERE}`);
    }
    [places[part]] = loose;
  }
  return places;
}

// Name in small letters, without its unit and the signs between words.
function normal(name, words) {
  const plain = name.toLowerCase().replace(/[^a-z0-9]+/g, "");
  if (Object.values(words.names).some((known) => known.includes(plain))) return plain;
  return withoutUnit(name, words).toLowerCase().replace(/[^a-z0-9]+/g, "");
}

function wordsOf(name, words) {
  const list = withoutUnit(name, words).toLowerCase().split(/[^a-z0-9]+/).filter((word) => word.length > 1);
  return list.some((word) => words.otherQuantities.includes(word)) ? [] : list;
}

function withoutUnit(name, words) {
  return unitOf(name, words) === "" ? name : name.trim().replace(UNIT, "");
}

// Unit at the end of a name, as in command_mm or "command [mm]"; empty where none is stated.
function unitOf(name, words) {
  const match = UNIT.exec(name.trim());
  if (match === null || Object.values(words.names).some((known) => known.includes(name.toLowerCase().replace(/[^a-z0-9]+/g, "")))) return "";
  const unit = (match[1] ?? match[2]).toLowerCase();
  return [words.lengths, words.times].some((units) => Object.hasOwn(units, unit)) || words.otherUnits.includes(unit) ? unit : "";
}

// Step between times, which must be equal but for the rounding of the times.
function stepOf(times) {
  const steps = times.subarray(1).map((time, i) => time - times[i]), usual = median(steps);
  const average = (times[times.length - 1] - times[0]) / steps.length;
  if (!(average > 0)) throw new ReadingError("Times must increase.");
  const rounded = steps.filter((step) => Math.abs(step - usual) > 0.01 * Math.abs(usual)).length > 0.01 * steps.length;
  const rounding = 1.01 * roundingOf(times);
  const [expected, allowed] = rounded ? [average, rounding] : [usual, 0];
  const wrong = steps.findIndex((step) => !(Math.abs(step - expected) <= allowed + 0.01 * Math.abs(expected)));
  if (wrong >= 0) throw new ReadingError(`Samples must follow each other at equal steps: row ${wrong + 2} does not.`);
  const late = times.findIndex((time, i) => Math.abs(time - times[0] - i * average) > 0.02 * average + rounding);
  if (late >= 0) throw new ReadingError(`The step between samples must not change: row ${late + 1} is off equal steps. ${ELSEWHERE}`);
  return average;
}

// One unit in the last decimal that the times have.
function roundingOf(times) {
  const largest = times.reduce((most, time) => Math.max(most, Math.abs(time)), 1);
  for (let digits = 0; digits <= 9; digits += 1) {
    if (times.every((time) => Math.abs(time - Number(time.toFixed(digits))) <= 1e-12 * largest)) return 10 ** -digits;
  }
  return 0;
}
