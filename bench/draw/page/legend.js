// The panels: the caption, and the legend that switches layers.

const grouped = (n) => n.toLocaleString("en-US");
const plural = (n, one) => `${grouped(n)} ${one}${n === 1 ? "" : "s"}`;

function writeCaption() {
  const c = now.counts;
  const caption = document.getElementById("caption");
  caption.querySelector("h1").textContent = `${c.partition} on ${c.scene}, frame ${c.frame}`;
  const some = c.objects_drawn < c.objects ? ` (${grouped(c.objects_drawn)} drawn)` : "";
  const paired = c.pairs_drawn < c.pairs ? ` (${grouped(c.pairs_drawn)} drawn)` : "";
  const untested = c.reported > c.pairs ? ` of ${grouped(c.reported)} reported` : "";
  const found = `${plural(c.objects, "object")}${some}, ${plural(c.pairs, "pair")}${untested}${paired}`;
  caption.querySelector("p").replaceChildren(found, make("br"), structureText(c));
  document.title = `winnow: ${c.partition}, ${c.scene}, frame ${c.frame}`;
}

function structureText(c) {
  const names = Object.keys(c.structure);
  if (names.length === 0) return "no structure: every object is tested against every other";
  const levels = names.filter((name) => name.startsWith("nodes"));
  const nodes = levels.reduce((sum, name) => sum + c.structure[name], 0);
  const parts = [];
  const inTree = c.structure.cells ? c.irregular : c.objects;
  if (c.structure.cells) {
    parts.push(`${grouped(c.structure.cells)} of ${plural(c.cells, kCell)} in use, with ` +
               plural(c.regular, "object"));
  }
  if (nodes) {
    const some = levels.length < c.depth ? `${levels.length} of ` : "";
    parts.push(`${plural(nodes, "node")} on ${some}${plural(c.depth, "level")}, with ` +
               plural(inTree, "object"));
  }
  return parts.join("; ");
}

function entryFor(layer) {
  const colour = `rgb(${layer.colour})`;
  return make("label", {},
    make("input", {type: "checkbox", checked: layer.shown, onchange: ({target}) => {
      kSwitched.set(layer.name, target.checked);
      layer.show(target.checked);
      drawSoon();
    }}),
    make("span", {className: `swatch ${layer.mark}`,
                  style: `background: ${colour}; border-color: ${colour}`}),
    layer.name, make("span", {className: "count", textContent: grouped(layer.count)}));
}

function writeLegend() {
  const parts = ["Objects", "Structure", "Queries"].flatMap((group) => {
    const entries = kLayers.filter((layer) => layer.group === group).map(entryFor);
    if (entries.length === 0) return [];
    return [make("h2", {textContent: group}), ...entries];
  });
  document.getElementById("legend").replaceChildren(
    ...parts, make("button", {textContent: "reset the view", onclick: resetView}),
    make("p", {textContent: "Drag to turn, right-drag to move, wheel to zoom. " +
                            "Point at an object or click it."}));
}
