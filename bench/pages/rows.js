"use strict";
// Rows of the results as the views read them. A name is a family and segments: "key:value", or a
// word, which is the value of the next key of the family. pages.cmake inserts rows/families.json.

const FAMILIES = @kFamilies@;
const CURVES = ["angle", "ratio", "offset", "thinness"];
const WHOLE = {batch: {call: "batch"}, single: {call: "single"}, real_time: {}, manual_time: {}};

const file = JSON.parse(document.getElementById("data").textContent);
const context = file.context || {};
const shown_name = (text) => String(text).replaceAll("_", " ");
const number_of = (text) => text !== "" && isFinite(text) ? Number(text) : text;

function parsed(row) {
  const [family, ...segments] = String(row.run_name || row.name).split("/");
  const words = (FAMILIES[family]?.keys || []).filter((key) => !segments.some((one) => one.startsWith(`${key}:`)));
  const keys = {};
  for (const segment of segments) {
    const colon = segment.indexOf(":");
    if (colon > 0) keys[segment.slice(0, colon)] = number_of(segment.slice(colon + 1));
    else if (segment in WHOLE) Object.assign(keys, WHOLE[segment]);
    else keys[words.shift() || `word${Object.keys(keys).length}`] = segment;
  }
  if (family === "pair" && !keys.engine) keys.engine = "robust";
  if (family === "partition") Object.assign(keys, {call: keys.call || "single", threads: keys.threads || 1});
  for (const curve of family === "stability" ? CURVES : []) {
    if (curve in keys) Object.assign(keys, {curve, parameter: keys[curve]});
    delete keys[curve];
  }
  const one = {...row, ...keys, $family: family, $keys: keys};
  one.each = row.ns_per_pair ?? row.ns_per_query ?? row.ns_per_object ?? row.ns_per_ray;
  if (keys.objects && row.real_time > 0) one.us_per_object = row.real_time * 1000 / keys.objects;
  return one;
}

// One row for each name: of repeated measurements the median, or the last one.
const families = new Map();
{
  const all = new Map();
  for (const row of file.benchmarks || []) {
    const name = row.run_name || row.name;
    const aggregate = row.run_type === "aggregate";
    if (aggregate && row.aggregate_name !== "median") continue;
    if (!aggregate && all.get(name)?.run_type === "aggregate") continue;
    all.set(name, row);
  }
  for (const row of all.values()) {
    const one = parsed(row);
    if (!families.has(one.$family)) families.set(one.$family, []);
    families.get(one.$family).push(one);
  }
}

const has_all = (row, members) => Object.entries(members).every(([key, value]) => row[key] === value);

// The rows of a family whose members equal those of `where`.
function rows(family, where = {}) {
  return (families.get(family) || []).filter((row) => has_all(row, where));
}

const distinct = (list, key) => [...new Set(list.map((row) => row[key]))].filter((v) => v !== undefined);
const median = (values) => values.slice().sort((a, b) => a - b)[values.length >> 1];

const LIBRARIES = /^(bullet|fcl|cgal|embree|ode|libccd|jolt)(_|$)/;
const is_library = (name) => LIBRARIES.test(name);
const is_base = (name) => /^(yardstick|read|reading|footprint)/.test(name);

// Three digits; powers of ten beyond a million and below a thousandth.
function short(value) {
  if (typeof value !== "number") return value === undefined ? "-" : String(value);
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size < 0.001) return value.toExponential(1);
  if (Number.isInteger(value) || size >= 1000) return Math.round(value).toLocaleString("en-US");
  return value.toPrecision(3);
}

// "update_ms" as "update, ms".
function label(field) {
  const unit = /^(.*)_(ms|us|ns|bytes|degrees|rad)$/.exec(field);
  const known = {real_time: "time", iterations: "samples", real_time_min: "least time", real_time_max: "greatest time", each: "time, ns", us_per_object: "time of an object, us"};
  return known[field] || shown_name(unit ? `${unit[1]}, ${unit[2]}` : field);
}
