"use strict";
// Added to a report's page by pages.cmake: opens all sections, shows every view with every value in turn, and
// writes to data attributes of the body what was drawn.

const facts = document.body.dataset;
const failed = [];
window.addEventListener("error", (event) => failed.push(event.message));

// The share of a canvas that is drawn, in percent, read from a small copy of it.
const copy = new OffscreenCanvas(100, 100).getContext("2d", {willReadFrequently: true});
function drawn(canvas) {
  if (canvas.width === 0 || canvas.height === 0) return 0;
  copy.clearRect(0, 0, 100, 100);
  copy.drawImage(canvas, 0, 0, 100, 100);
  const {data} = copy.getImageData(0, 0, 100, 100);
  let count = 0;
  for (let i = 3; i < data.length; i += 4) count += data[i] > 0;
  return count / 100;
}

function beyond() {
  return Math.max(0, document.documentElement.scrollWidth - document.documentElement.clientWidth);
}

function choose(list, index) {
  list.selectedIndex = index;
  list.dispatchEvent(new Event("change"));
}

const theme = document.getElementById("theme");
const before = getComputedStyle(document.body).backgroundColor;
facts.paper = before;
theme.click();
facts.switched = getComputedStyle(document.body).backgroundColor !== before;
theme.click();

const card = document.getElementById("card").getBoundingClientRect();
facts.answered = Math.round(document.querySelector("#card dl")?.getBoundingClientRect().bottom || 0);
facts.card = Math.round(card.bottom);
facts.closed = document.documentElement.scrollHeight;
// The names and lengths of the bars of a chart, as they are drawn.
const bars_of = (box, name) => {
  const chart = box && Chart.getChart(box.querySelector("canvas"));
  return chart ? chart.getDatasetMeta(0)._parsed.map(({x}, i) => [name(chart, i), x]) : [];
};
const fact_of = (head) => [...document.querySelectorAll("#card dt")].find((dt) => dt.textContent === head)?.nextSibling.textContent;
const trace = {
  settings: [...document.querySelectorAll("#card select")].map((list) => list.value),
  take: document.querySelector("#card strong")?.textContent, fast: fact_of("how fast"),
  card: bars_of(document.getElementById("card"), (chart, i) => chart.data.labels[i])};
let wide = beyond();
let shown = 0;
let tallest = 0;
const blank = [];
const details = [...document.querySelectorAll("details")];
for (const one of details) {
  one.open = true;
  one.dispatchEvent(new Event("toggle"));
}
trace.chart = bars_of(details[0], (chart, i) => chart.data.datasets[0].data[i].name);
facts.trace = JSON.stringify(trace);
const every_view = new Map(details.map((one) => [one, one.querySelector("select")?.options.length || 0]));
for (let view = 0; view < Math.max(...every_view.values()); ++view) {
  for (const [one, count] of every_view) {
    const canvas = one.querySelector("canvas");
    if (view >= count) continue;
    choose(one.querySelector("select"), view);
    const values = () => [...one.querySelectorAll(".controls label")].find((label) => label.textContent.startsWith("value "))?.querySelector("select");
    for (let value = 0; value < (values()?.options.length || 1); ++value) {
      if (values()) choose(values(), value);
      ++shown;
      const name = one.querySelector("select").value + (values() ? `, ${values().value}` : "");
      if (canvas && !canvas.parentElement.hidden && drawn(canvas) < 1) blank.push(name);
      if (one.querySelectorAll("tbody tr").length === 0) blank.push(`${name}: no rows`);
      if (canvas && !canvas.parentElement.hidden) {
        const chart = Chart.getChart(canvas);
        const x = chart.scales.x;
        if (x.type === "logarithmic" && Math.abs(Math.log10(x.min) - Math.round(Math.log10(x.min))) > 1e-6) blank.push(`${name}: no decade`);
        if (chart.options.indexAxis === "y" && chart.scales.y.ticks.some((tick) => !tick.label)) blank.push(`${name}: a bar without a name`);
      }
    }
  }
  wide = Math.max(wide, beyond());
  tallest = Math.max(tallest, document.documentElement.scrollHeight);
}
Object.assign(facts, {shown, height: tallest, beyond: wide, sections: details.length, blank: blank.join("; "), failed: failed.join("; ")});
