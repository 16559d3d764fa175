// Draws every plot of the page's data; pages/plot_page.cpp writes the data. Series of one name have
// one colour in all plots. The colours are safe for colour-blind readers, and each series has its
// own mark.

const data = JSON.parse(document.getElementById("plots").textContent);

const palette = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000",
                 "#7f6000", "#8c8c8c", "#6a3d9a"];
const marks = ["circle", "triangle", "rect", "rectRot", "star", "crossRot", "cross", "rectRounded"];
const first = data.names;
const others = [];
for (const plot of data.plots) {
  for (const series of plot.series) {
    if (!first.includes(series.name) && !others.includes(series.name) && !series.front) {
      others.push(series.name);
    }
  }
}

// Partitions, which are listed on all pages, have solid lines; other names have dashed ones if a
// plot has both.
function look(name) {
  const known = first.indexOf(name);
  if (known >= 0) return {colour: palette[known % palette.length], mark: marks[known % 8]};
  const i = others.indexOf(name);
  return {colour: palette[i % palette.length], mark: marks[(i + 3) % 8], other: true};
}

function dataset(series, plot) {
  const {colour, mark, other} = look(series.name);
  const mixed = plot.series.some((one) => first.includes(one.name));
  if (plot.categories.length > 0) {
    // Colours the bars of a series by category if the categories are partitions.
    const known = plot.categories.some((name) => first.includes(name));
    const of_category = (point) => palette[first.includes(plot.categories[point.x]) ? 0 : 1];
    return {
      label: series.name,
      data: series.points.map((point) => ({...point, x: plot.categories[point.x]})),
      backgroundColor: known ? series.points.map(of_category) : colour,
      borderColor: "#ffffff",
      borderWidth: 0.5,
    };
  }
  if (series.front) {
    return {label: series.name, data: series.points, showLine: true, pointRadius: 0,
            pointStyle: "line", borderColor: "#444444", backgroundColor: "#444444",
            borderWidth: 1, borderDash: [2, 2], stepped: "before"};
  }
  return {
    label: series.name,
    data: series.points,
    showLine: series.line !== false,
    borderColor: colour,
    backgroundColor: colour,
    borderDash: mixed && other ? [6, 4] : [],
    pointStyle: mark,
    clip: 6,
    pointRadius: series.points.length > 60 ? 1.5 : 4,
    pointHoverRadius: 7,
    borderWidth: 1.5,
  };
}

// Labels of a logarithmic axis: powers of ten, and with enough room 2 and 5 times these, in their
// shortest form: 20, 1,000, 1e-7.
function log_tick(value) {
  const size = Math.abs(value);
  const digit = Math.round(size / 10 ** Math.floor(Math.log10(size) + 1e-9));
  const room = this.max < 1000 * this.min;
  if (digit !== 1 && !(room && (digit === 2 || digit === 5))) return "";
  const long = size < 1e-3 || size >= 1e7 || (size >= 1e5 && this.max >= 1e8);
  return long ? value.toExponential(0).replace("+", "") : value.toLocaleString("en");
}

// Returns the range of the whiskers, which the axes must include.
function ends(plot) {
  const points = plot.series.flatMap((series) => series.points);
  const lows = points.map((point) => point.low).filter((low) => low > 0 || !plot.y.log);
  const known = (values) => values.filter(Number.isFinite);
  return {
    suggestedMin: known(lows).reduce((a, b) => Math.min(a, b), Infinity),
    suggestedMax: known(points.map((point) => point.high)).reduce((a, b) => Math.max(a, b),
                                                                    -Infinity),
  };
}

function scale(axis, plot) {
  const bars = plot.categories.length > 0;
  const category = bars && axis === plot.x;
  const {suggestedMin, suggestedMax} = ends(plot);
  const whiskered = axis === plot.y && !bars && suggestedMin < suggestedMax;
  // Axes without negative values start at zero; axes of integers have integer ticks.
  const values = axis === plot.y && !axis.log
    ? plot.series.flatMap((series) => series.points.map((point) => point.y)) : [];
  const from_zero = values.length > 0 && values.every((y) => y >= 0);
  const whole = values.length > 0 && values.every(Number.isInteger);
  return {
    ...(whiskered ? {suggestedMin, suggestedMax} : {}),
    ...(from_zero ? {min: 0} : {}),
    ...(from_zero && values.every((y) => y === 0) ? {suggestedMax: 1} : {}),
    type: category ? "category" : axis.log ? "logarithmic" : "linear",
    labels: category ? plot.categories : undefined,
    stacked: bars && plot.stacked,
    title: {display: true, text: axis.label},
    ticks: axis.log ? {callback: log_tick, maxRotation: 0} : whole ? {precision: 0} : {},
    grid: {color: "#e4e4e4"},
  };
}

function described(item) {
  const point = item.raw;
  return `${item.dataset.label}: ${point.note || `${point.x}, ${point.y}`}`;
}

// Draws a line from the least to the greatest measured value.
const whiskers = {
  id: "whiskers",
  afterDatasetsDraw(chart) {
    const {ctx, chartArea: area} = chart;
    ctx.save();
    ctx.beginPath();
    ctx.rect(area.left, area.top, area.width, area.height);
    ctx.clip();
    chart.data.datasets.forEach((set, i) => {
      if (!chart.isDatasetVisible(i)) return;
      ctx.strokeStyle = set.borderColor;
      ctx.lineWidth = 1;
      chart.getDatasetMeta(i).data.forEach((mark, k) => {
        const {low, high} = set.data[k];
        if (low === undefined || high === undefined) return;
        const y = chart.scales.y;
        ctx.beginPath();
        ctx.moveTo(mark.x, y.getPixelForValue(Math.max(low, y.min)));
        ctx.lineTo(mark.x, y.getPixelForValue(high));
        ctx.stroke();
      });
    });
    ctx.restore();
  },
};

// Zoom: the wheel zooms at the pointer, dragging moves, a double click shows everything again.
// Until a plot is clicked, the wheel scrolls the page.
function zoomable(chart) {
  const canvas = chart.canvas;
  let awake = false;
  const axes = ["x", "y"].filter((axis) => chart.scales[axis].type !== "category");
  const along = (axis, event) => {
    const s = chart.scales[axis];
    return s.getValueForPixel(axis === "x" ? event.offsetX : event.offsetY);
  };
  const change = (axis, map) => {
    const s = chart.scales[axis];
    const log = s.type === "logarithmic";
    const [low, high] = map(log ? Math.log(s.min) : s.min, log ? Math.log(s.max) : s.max, log);
    chart.options.scales[axis].min = log ? Math.exp(low) : low;
    chart.options.scales[axis].max = log ? Math.exp(high) : high;
  };
  canvas.title = "click, then turn the wheel to zoom; drag to move; double click for everything";
  canvas.addEventListener("mouseleave", () => { awake = false; });
  canvas.addEventListener("wheel", (event) => {
    if (!awake) return;
    event.preventDefault();
    const factor = event.deltaY > 0 ? 1.25 : 0.8;
    for (const axis of axes) {
      const value = along(axis, event);
      change(axis, (low, high, log) => {
        const at = log ? Math.log(value) : value;
        return [at + (low - at) * factor, at + (high - at) * factor];
      });
    }
    chart.update("none");
  }, {passive: false});
  let held = null;
  canvas.addEventListener("mousedown", (event) => {
    held = event;
    awake = true;
  });
  window.addEventListener("mouseup", () => { held = null; });
  canvas.addEventListener("mousemove", (event) => {
    if (held === null) return;
    for (const axis of axes) {
      const from = along(axis, held);
      const to = along(axis, event);
      change(axis, (low, high, log) => {
        const moved = log ? Math.log(from) - Math.log(to) : from - to;
        return [low + moved, high + moved];
      });
    }
    held = event;
    chart.update("none");
  });
  const least = Object.fromEntries(axes.map((axis) => [axis, chart.options.scales[axis].min]));
  canvas.addEventListener("dblclick", () => {
    for (const axis of axes) {
      chart.options.scales[axis].min = least[axis];
      delete chart.options.scales[axis].max;
    }
    chart.update("none");
  });
}

// Counts the marks of a series (points, or ends of bars) that are within the axes.
function drawn_of(chart, i) {
  const area = chart.chartArea;
  return chart.getDatasetMeta(i).data.filter((mark) =>
    Number.isFinite(mark.x) && Number.isFinite(mark.y) && mark.x >= area.left - 1 &&
    mark.x <= area.right + 1 && mark.y >= area.top - 1 && mark.y <= area.bottom + 1).length;
}

const counts = {drawn: 0, points: 0, plots: 0};
const blank = [];

function draw(plot) {
  const chart = new Chart(document.getElementById(plot.id), {
    type: plot.categories.length > 0 ? "bar" : "scatter",
    data: {datasets: plot.series.map((series) => dataset(series, plot))},
    plugins: [whiskers],
    options: {
      animation: false,
      maintainAspectRatio: false,
      devicePixelRatio: Math.max(2, window.devicePixelRatio || 1),
      scales: {x: scale(plot.x, plot), y: scale(plot.y, plot)},
      plugins: {
        title: {display: true, text: plot.title, font: {size: 15}},
        legend: {display: plot.series.length > 1, position: "bottom",
                 labels: {usePointStyle: true, boxHeight: 7}},
        tooltip: {callbacks: {label: described}},
      },
    },
  });
  zoomable(chart);
  let here = 0;
  let points = 0;
  plot.series.forEach((series, i) => {
    here += drawn_of(chart, i);
    points += series.points.length;
  });
  if (here < points) blank.push(plot.id);
  counts.drawn += here;
  counts.points += points;
  counts.plots += 1;
}

// Charts in a folded section have no size and are drawn when it is opened.
const waiting = new Set(data.plots);
function draw_open() {
  for (const plot of waiting) {
    if (document.getElementById(plot.id).closest("details:not([open])") !== null) continue;
    waiting.delete(plot);
    draw(plot);
  }
  // Tests of the page read these.
  for (const [name, count] of Object.entries(counts)) document.body.dataset[name] = String(count);
  document.body.dataset.blank = blank.join(" ");
  const card = document.getElementById("recommendation");
  if (card !== null) document.body.dataset.answered = String(card.getBoundingClientRect().bottom);
  document.body.dataset.height = String(document.documentElement.scrollHeight);
  document.body.dataset.beyond = String(document.documentElement.scrollWidth - window.innerWidth);
}

// A link to a section opens it; "#all" and printing open all sections.
function open_all() {
  for (const folded of document.querySelectorAll("details")) folded.open = true;
  draw_open();
}
function open_target() {
  const name = decodeURIComponent(location.hash.slice(1));
  if (name === "all") return open_all();
  const section = name === "" ? null : document.getElementById(name);
  if (section === null) return;
  for (const folded of section.querySelectorAll("details.section")) folded.open = true;
  draw_open();
  section.scrollIntoView();
}
for (const folded of document.querySelectorAll("details")) {
  folded.addEventListener("toggle", draw_open);
}
window.addEventListener("hashchange", open_target);
window.addEventListener("beforeprint", open_all);
draw_open();
open_target();
