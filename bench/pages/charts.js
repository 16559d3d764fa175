"use strict";
// Declarations of Chart.js for the views: bars, lines and dots of rows, and what all charts share.

const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const is_dark = () => style("--dark") === "1";

// Cold hues are winnow, warm hues other libraries, grey what both are compared with.
const hues = {own: [210, 165, 255, 188, 232, 140, 280, 200], library: [25, 5, 42, 345, 15, 55]};
const places = new Map();
function colour(name, purpose = is_base(name) ? "base" : is_library(name) ? "library" : "own") {
  const light = is_dark() ? 66 : 42;
  if (purpose === "base") return `hsl(0 0% ${light + 8}%)`;
  if (!places.has(name)) {
    places.set(name, [...places.keys()].filter((n) => is_library(n) === is_library(name)).length);
  }
  const place = places.get(name);
  const of = hues[purpose];
  return `hsl(${of[place % of.length]} 70% ${light + 7 * (Math.floor(place / of.length) % 3)}%)`;
}
const bar_colour = (name) =>
  is_base(name) ? colour(name) : is_library(name) ? style("--library") : style("--own");

// Right and wrong have colours of their own; other parts are steps from dark to light.
const MEANINGS = {right: "hsl(145 55% 42%)", wrong: "hsl(5 70% 50%)", not_taken: "hsl(0 0% 62%)"};
const part_colour = (field, i, count) => MEANINGS[field] || `hsl(${210 + 60 * (i % 2)} 55% ${30 + 50 * i / count}%)`;

const decade = (value) => 10 ** Math.floor(Math.log10(value) + 1e-9);
const is_decade = (value) => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-6;

// An axis from a decade to a decade, if the values are above 0 and span more than one decade.
function axis(title, values, logarithmic) {
  const positive = values.filter((v) => v > 0);
  const least = Math.min(...positive);
  const most = Math.max(...positive);
  const common = {title: {display: true, text: title, color: style("--ink")},
                  grid: {color: style("--line")}, ticks: {color: style("--faint"), maxRotation: 0}};
  if (logarithmic === false || positive.length === 0 || (!logarithmic && most < 10 * least)) {
    common.ticks.callback = (value) => short(value);
    return {...common, type: "linear", beginAtZero: true};
  }
  const zero = values.some((v) => v === 0);
  const from = decade(least) / (zero ? 10 : 1);
  const to = is_decade(most) ? decade(most) : 10 * decade(most);
  const decades = Math.log10(to / from);
  const every = Math.ceil(decades / 8);
  common.ticks.autoSkip = false;
  common.ticks.callback = (value) => {
    if (!is_decade(value)) return decades < 2.5 && /^[25]/.test(value.toExponential()) ? short(value) : "";
    return Math.round(Math.log10(value / from)) % every ? "" : zero && value === from ? "0" : short(value);
  };
  common.grid.color = (line) => is_decade(line.tick.value) ? style("--line") : "transparent";
  return {...common, type: "logarithmic", min: from, max: to > from ? to : 10 * from};
}

const shared = (tooltip) => ({
  animation: false, responsive: true, maintainAspectRatio: false, normalized: true,
  plugins: {
    legend: {position: "bottom", labels: {color: style("--ink"), usePointStyle: true, boxWidth: 8, font: {size: 11}}},
    tooltip: {filter: ({raw}) => !Array.isArray(raw), callbacks: {title: () => "", label: tooltip}}}});

const note = (field) => (item) => {
  const row = item.raw;
  const at = typeof field === "function" ? field(item) : field;
  const ends = row[`${at}_max`] === undefined ? "" : ` (${short(row[`${at}_min`])} to ${short(row[`${at}_max`])})`;
  return [String(row.run_name || row.name), `${label(at)}: ${short(row[at])}${ends}`];
};

// One bar for each row, named with its value, the best first; several fields are stacked. The bar of one field has a
// whisker from the least to the greatest sample.
function bars(list, key, fields, unit) {
  const sum = (row) => fields.reduce((total, field) => total + (row[field] || 0), 0);
  const sorted = list.filter((row) => Number.isFinite(sum(row))).sort((a, b) => sum(a) - sum(b));
  const stacked = fields.length > 1;
  const options = shared(note((item) => item.dataset.parsing.xAxisKey));
  options.plugins.legend.display = stacked;
  const datasets = fields.map((field, i) => ({
    label: label(field), data: sorted, parsing: {xAxisKey: field, yAxisKey: key},
    backgroundColor: stacked ? part_colour(field, i, fields.length) : sorted.map((row) => bar_colour(String(row[key]))),
    barPercentage: 0.8, categoryPercentage: 0.95, minBarLength: 1}));
  const ends = sorted.map((row) => [row[`${fields[0]}_min`], row[`${fields[0]}_max`]]);
  if (!stacked) {
    datasets.push({data: ends.map((pair) => pair.every(Number.isFinite) ? pair : null), backgroundColor: style("--faint"),
                   grouped: false, barThickness: 2, order: -1});
  }
  return {
    type: "bar", data: {labels: sorted.map((row) => row[key]), datasets},
    options: {...options, indexAxis: "y",
              scales: {x: {...axis(unit, sorted.map(sum), stacked ? false : undefined), stacked},
                       y: {stacked, grid: {display: false},
                           ticks: {autoSkip: false, color: style("--ink"),
                                   callback: (i) => `${shown_name(sorted[i][key])}  ${short(sum(sorted[i]))}`}}}}};
}

const marks = ["circle", "triangle", "rect", "rectRot", "star", "crossRot", "rectRounded"];

// A line, or dots, for each value of `by`.
function curves(list, by, x, y, x_title, y_title, line) {
  const known = list.filter((row) => Number.isFinite(row[x]) && Number.isFinite(row[y]));
  const scales = {x: axis(x_title, known.map((row) => row[x])), y: axis(y_title, known.map((row) => row[y]))};
  // An error of 0 is drawn at the end of a logarithmic axis.
  const drawn = known.map((row) => ({...row, at: scales.y.type === "logarithmic" ? Math.max(row[y], scales.y.min) : row[y]}));
  const names = by ? distinct(drawn, by) : [y];
  const sets = names.map((name, i) => {
    const data = drawn.filter((row) => !by || row[by] === name).sort((a, b) => a[x] - b[x]);
    const tint = colour(String(name));
    return {label: shown_name(name), data, parsing: {xAxisKey: x, yAxisKey: "at"}, showLine: line,
            borderColor: tint, backgroundColor: tint, borderWidth: 1.5, pointStyle: marks[i % marks.length],
            borderDash: is_library(String(name)) ? [5, 3] : [], pointRadius: data.length > 60 ? 1 : 3.5, clip: 8};
  });
  return {type: "scatter", data: {datasets: sets}, options: {...shared(note(y)), scales}};
}
