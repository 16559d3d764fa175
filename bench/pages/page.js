"use strict";
// Builds the page: the card that answers which partition to take, and folded sections of views.

Chart.defaults.font.family = "system-ui, sans-serif";
const redraws = [];  // functions that draw what is visible again
const draw_all = () => redraws.forEach((redraw) => redraw());

function select(name, choices, chosen, changed) {
  const list = make("select", {onchange: () => changed(choices[list.selectedIndex])},
    ...choices.map((choice) => make("option", {selected: choice === chosen, textContent: short_choice(name, choice)})));
  return make("label", {}, shown_name(name) + " ", list);
}
const short_choice = (name, choice) =>
  Array.isArray(choice) ? "sum by parts" : typeof choice === "number" ? short(choice) : name === "value" ? label(choice) : shown_name(choice);

// Draws a chart into a box; `count` bars need at least their height.
function chart_into(box, config, count) {
  Chart.getChart(box.querySelector("canvas"))?.destroy();
  box.style.height = `${config.type === "bar" ? Math.min(430, 90 + 21 * count) : 330}px`;
  new Chart(box.querySelector("canvas"), config);
}
const chart_box = () => make("div", {className: "chart"}, make("canvas", {ariaLabel: "chart"}));

const HIDDEN = new Set(["name", "run_name", "run_type", "cpu_time", "$keys", "$family", "command", "repetitions",
                        "repetition_index", "time_unit", "family_index", "per_family_instance_index", "aggregate_name"]);
const MOST_LINES = 100;

// A table of all members of the rows; a click on a heading sorts by it.
function table(list) {
  const columns = [...new Set(list.flatMap(Object.keys))].filter((name) => !HIDDEN.has(name));
  const keys = new Set(list.flatMap((row) => Object.keys(row.$keys || {})));
  columns.sort((a, b) => keys.has(b) - keys.has(a));
  const kept = columns.filter((name) => !list.every((row) => row[name] === 0 || row[name] === undefined) || keys.has(name));
  const body = make("tbody");
  const fill = (rows_shown) => body.replaceChildren(...rows_shown.slice(0, MOST_LINES).map((row) => make("tr", {title: row.command || row.run_name || row.name},
    ...kept.map((name) => make("td", {className: typeof row[name] === "number" ? "" : "words",
                                      textContent: keys.has(name) ? shown_name(short(row[name])) : short(row[name])})))));
  const order = (name) => fill(list.slice().sort((a, b) => (a[name] > b[name]) - (a[name] < b[name])));
  fill(list);
  return make("table", {}, make("thead", {}, make("tr", {}, ...kept.map((name) =>
    make("th", {onclick: () => order(name), className: list.some((row) => typeof row[name] === "string") ? "words" : "", textContent: name === "real_time" ? `time, ${list[0].time_unit}` : label(name)})))), body);
}

// The choice at first: the most objects, the threads with the most rows, this machine's instructions.
function usual(name, choices, list) {
  const count = (choice) => list.filter((row) => row[name] === choice).length;
  if (name === "threads") return choices.reduce((best, one) => count(one) >= count(best) ? one : best);
  if (name === "objects") return choices.at(-1);
  return choices.find((choice) => ["distance", "box-box", context.isa].includes(choice)) ?? choices[0];
}

// Menus of the values of these keys, if there are at least so many, and the rows that have the chosen ones.
function selection(list, names, state, redraw, fewest = 2) {
  const menus = [];
  for (const name of names) {
    const choices = distinct(list, name).sort((a, b) => typeof a === "number" ? a - b : 0);
    if (choices.length < fewest) continue;
    const chosen = choices.includes(state.get(name)) ? state.get(name) : usual(name, choices, list);
    menus.push(select(name, choices, chosen, (value) => { state.set(name, value); redraw(); }));
    list = list.filter((row) => row[name] === chosen);
  }
  return [menus, list];
}

// A section: a selection of its views, the selections of the view, a chart, a table and a command.
function add_section(title, of_section) {
  let at = of_section[0];
  const state = new Map();
  const controls = make("div", {className: "controls"});
  const text = make("p", {className: "text"});
  const box = chart_box();
  const rows_box = make("div", {className: "rows"});
  const command = make("code", {className: "command"});
  const details = make("details", {ontoggle: () => draw()}, make("summary", {}, make("h2", {textContent: title})),
                       controls, text, box, rows_box, command);
  function draw() {
    if (!details.open) return;
    const views_menu = select("show", of_section.map((one) => one.title), at.title, (name) => {
      at = of_section.find((one) => one.title === name);
      draw();
    });
    // The reader selects by the keys that the chart does not show.
    const all = rows_of(at);
    const keys = new Set(all.flatMap((row) => Object.keys(row.$keys)));
    const [menus, list] = selection(all, [...keys].filter((key) => !at.keys.includes(key)), state, draw);
    const fields = at.fields.filter((field) => [field].flat().some((name) => list.some((row) => Number.isFinite(row[name]))));
    const key = `value of ${at.title}`;
    const field = fields.includes(state.get(key)) ? state.get(key) : fields[0];
    if (fields.length > 1) menus.push(select("value", fields, field, (value) => { state.set(key, value); draw(); }));
    controls.replaceChildren(views_menu, ...menus);
    text.textContent = at.text ?? "";
    box.hidden = field === undefined;
    if (field !== undefined) chart_into(box, at.draw(list, field), distinct(list, at.keys[0]).length);
    rows_box.replaceChildren(table(list));
    command.textContent = list.find((row) => row.command)?.command || "";
  }
  redraws.push(draw);
  document.getElementById("sections").append(details);
}

// Every row of the results, by family and text.
function add_every_row() {
  let family = [...families.keys()][0];
  const rows_box = make("div", {className: "rows"});
  const search = make("input", {type: "search", placeholder: "words of the name", oninput: () => fill()});
  const fill = () => {
    const words = search.value.toLowerCase().split(" ");
    const list = rows(family).filter((row) => words.every((word) => String(row.run_name || row.name).toLowerCase().includes(word)));
    rows_box.replaceChildren(list.length ? table(list) : "no rows",
      list.length > MOST_LINES ? `${MOST_LINES} of ${short(list.length)} rows: write words of a name` : "");
  };
  const details = make("details", {ontoggle: () => fill()}, make("summary", {}, make("h2", {textContent: "Every row"})),
    make("div", {className: "controls"}, select("family", [...families.keys()], family, (name) => { family = name; fill(); }), search), rows_box);
  document.getElementById("sections").append(details);
}

const percent = (share) => `${(100 * share).toPrecision(2)} %`;

// How far the median of a measurement typically lies above its least sample.
function noise() {
  const shares = rows("throughput").filter((row) => row.iterations > 4 && row.real_time_min > 0)
    .map((row) => row.real_time / row.real_time_min - 1);
  return shares.length ? {share: median(shares), count: shares.length} : undefined;
}

// Errors of tier robust and of the libraries, over all kinds of pairs at one level.
function exactness() {
  const list = rows("error", {level: "distance", ratio: 1}).filter((row) => !("gap" in row));
  return distinct(list, "engine").filter((name) => name === "robust" || is_library(name)).map((name) => {
    const own = list.filter((row) => row.engine === name);
    const sum = (field) => own.reduce((total, row) => total + (row[field] || 0), 0);
    return {name, worst: Math.max(...own.map((row) => row.worst_error || 0)), wrong: sum("wrong"), pairs: sum("pairs"), kinds: own.length};
  });
}

// The card: one setting, chosen at its top, and for it the answer.
function add_card() {
  const all = rows("throughput", {isa: context.isa});
  const card = document.getElementById("card");
  card.hidden = all.length === 0;
  if (card.hidden) return;
  const state = new Map();
  const exact = exactness();
  const robust = exact.find((one) => one.name === "robust");
  const controls = make("div", {className: "controls"});
  const answer = make("h1");
  const facts = make("dl");
  const box = chart_box();
  card.append(controls, make("div", {className: "answer"}, make("div", {}, answer, facts), box));
  function draw() {
    const [menus, list] = selection(all, ["scene", "objects", "threads"], state, draw, 1);
    controls.replaceChildren(make("span", {textContent: "My scene is like"}), ...menus);
    const ranked = list.slice().sort((a, b) => a.real_time - b.real_time);
    const own = ranked.filter((row) => !is_library(row.partition) && !is_base(row.partition) && row.partition !== "auto_partition");
    const best = own[0];
    const library = ranked.find((row) => is_library(row.partition));
    const next = own[1];
    const loud = noise();
    answer.replaceChildren("Take ", make("strong", {textContent: best ? `${best.partition}()` : "no partition: none was measured"}));
    const lines = [];
    if (best) {
      const ends = best.real_time_min ? ` (${short(best.real_time_min)} to ${short(best.real_time_max)})` : "";
      lines.push(["how fast", `${short(best.real_time)} ms a frame${ends}`]);
    }
    if (next) {
      const ratio = next.real_time / best.real_time;
      lines.push(["next best", `${next.partition}(): ${short(ratio)} times this time` + (loud && ratio - 1 < loud.share ? ", within the noise" : "")]);
    }
    if (best && library) lines.push(["best library", `${shown_name(library.partition)}: ${short(library.real_time / best.real_time)} times this time`]);
    else if (best) lines.push(["libraries", "none was measured in this setting"]);
    if (best?.bytes_per_object) {
      const bytes = own.map((row) => row.bytes_per_object).filter(Boolean);
      lines.push(["memory", `${short(best.bytes_per_object)} bytes of an object; other partitions ${short(Math.min(...bytes))} to ${short(Math.max(...bytes))}`]);
    }
    const prints = distinct(list, "fingerprint");
    lines.push(["how exact", prints.length === 1 ? `all ${list.length} contenders found the same pairs, ${short(best?.pairs)} a frame`
                                                 : `contenders found ${prints.length} different sets of pairs`]);
    if (robust) lines.push(["exact shapes", `distances of ${robust.kinds} kinds of pairs, tier robust: worst error ${short(robust.worst)} of the size, ${robust.wrong} of ${short(robust.pairs)} verdicts wrong`]);
    if (loud) lines.push(["noise", `a median is typically ${percent(loud.share)} above the least time of its samples (${short(loud.count)} measurements); smaller differences are noise`]);
    facts.replaceChildren(...lines.flatMap(([head, line]) => [make("dt", {textContent: head}), make("dd", {textContent: line})]));
    chart_into(box, bars(list, "partition", ["real_time"], "ms a frame"), list.length);
  }
  redraws.push(draw);
  card.append(make("p", {className: "text", textContent: "Bars are medians; blue is winnow, orange other libraries, grey the yardstick, a sweep without state between frames. Whiskers go from the least to the greatest sample."}));
  if (exact.length > 1) {
    card.append(make("p", {className: "text", textContent: "Distances of the same pairs of shapes in other libraries: " +
      exact.filter((one) => one !== robust).map((one) => `${shown_name(one.name)} worst error ${short(one.worst)} of the size, ${one.wrong} wrong verdicts`).join("; ") + "."}));
  }
}

function add_origin() {
  const about = [context.machine, context.num_cpus && `${context.num_cpus} cores`, context.isa, context.compiler,
                 context.commit && `commit ${context.commit}`, context.date].filter(Boolean);
  document.getElementById("origin").textContent = about.join(", ");
  const notes = [...(context.problems || []).map((text) => `Problem: ${text}`), ...(context.warnings || []), ...(context.missing || [])];
  if (context.complete === false) notes.unshift("This report is not complete.");
  document.getElementById("notes").append(...notes.map((text) => make("span", {className: "note", textContent: text})));
}

const dress = (dark) => {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  draw_all();
};
document.getElementById("theme").onclick = () => dress(!is_dark());
const night = matchMedia("(prefers-color-scheme: dark)");
night.onchange = () => dress(night.matches);

add_origin();
add_card();
for (const section of distinct(views, "section")) {
  const of_section = views.filter((one) => one.section === section && rows_of(one).length > 0);
  if (of_section.length > 0) add_section(section, of_section);
}
add_every_row();
if (location.hash === "#all" || document.getElementById("card").hidden) for (const details of document.querySelectorAll("details")) details.open = true;
dress(night.matches);
