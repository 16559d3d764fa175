// Draws every plot of the page's data. Series of one name have one colour in all plots; colours
// are told apart by the colour-blind too, and each series has a mark of its own.

const data = JSON.parse(document.getElementById("plots").textContent);

const palette = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000",
                 "#7f6000", "#8c8c8c", "#6a3d9a"];
const marks = ["circle", "triangle", "rect", "rectRot", "star", "crossRot", "cross", "rectRounded"];
const names = [];
for (const plot of data.plots) {
  for (const series of plot.series) {
    if (!names.includes(series.name)) names.push(series.name);
  }
}

function dataset(series) {
  const i = names.indexOf(series.name);
  return {
    label: series.name,
    data: series.points,
    showLine: series.line !== false,
    borderColor: palette[i % palette.length],
    backgroundColor: palette[i % palette.length],
    pointStyle: marks[i % marks.length],
    pointRadius: 4,
    pointHoverRadius: 7,
    borderWidth: 1.5,
  };
}

function scale(axis) {
  return {
    type: axis.log ? "logarithmic" : "linear",
    title: {display: true, text: axis.label},
    grid: {color: "#e4e4e4"},
  };
}

function described(item) {
  const point = item.raw;
  return `${item.dataset.label}: ${point.note ?? `${point.x}, ${point.y}`}`;
}

// The wheel zooms about the pointer, dragging moves, a double click shows everything again.
function zoomable(chart) {
  const canvas = chart.canvas;
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
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const factor = event.deltaY > 0 ? 1.25 : 0.8;
    for (const axis of ["x", "y"]) {
      const value = along(axis, event);
      change(axis, (low, high, log) => {
        const at = log ? Math.log(value) : value;
        return [at + (low - at) * factor, at + (high - at) * factor];
      });
    }
    chart.update("none");
  }, {passive: false});
  let held = null;
  canvas.addEventListener("mousedown", (event) => { held = event; });
  window.addEventListener("mouseup", () => { held = null; });
  canvas.addEventListener("mousemove", (event) => {
    if (held === null) return;
    for (const axis of ["x", "y"]) {
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
  canvas.addEventListener("dblclick", () => {
    for (const axis of ["x", "y"]) {
      delete chart.options.scales[axis].min;
      delete chart.options.scales[axis].max;
    }
    chart.update("none");
  });
}

let drawn = 0;
for (const plot of data.plots) {
  const chart = new Chart(document.getElementById(plot.id), {
    type: "scatter",
    data: {datasets: plot.series.map(dataset)},
    options: {
      animation: false,
      maintainAspectRatio: false,
      scales: {x: scale(plot.x), y: scale(plot.y)},
      plugins: {
        title: {display: true, text: plot.title, font: {size: 15}},
        legend: {position: "right", labels: {usePointStyle: true}},
        tooltip: {callbacks: {label: described}},
      },
    },
  });
  zoomable(chart);
  for (let i = 0; i < plot.series.length; ++i) {
    const area = chart.chartArea;
    drawn += chart.getDatasetMeta(i).data.filter((mark) =>
      mark.x >= area.left && mark.x <= area.right && mark.y >= area.top &&
      mark.y <= area.bottom).length;
  }
}
// What a test of the page looks at.
document.body.dataset.drawn = String(drawn);
