// The panels: the caption, and the legend that switches layers.

const grouped = (n) => n.toString().replace(/\B(?=(\d{3})+$)/g, ",");
const plural = (n, one, many) => `${grouped(n)} ${n === 1 ? one : many || one + "s"}`;

function writeCaption() {
  const c = now.picture.counts;
  const caption = document.getElementById("caption");
  caption.querySelector("h1").textContent = `${c.partition} on ${c.scene}, frame ${c.frame}`;
  const lines = [];
  const some = c.objects_drawn < c.objects ? ` (${grouped(c.objects_drawn)} drawn)` : "";
  const paired = c.pairs_drawn < c.pairs ? ` (${grouped(c.pairs_drawn)} drawn)` : "";
  const untested = c.reported > c.pairs ? ` of ${grouped(c.reported)} reported` : "";
  lines.push(`${plural(c.objects, "object")}${some}, ${plural(c.pairs, "pair")}${untested}${paired}`);
  if (c.contacts) lines.push(`${plural(c.contacts, "point")} of contact`);
  lines.push(structureText(c));
  if (c.rays) {
    lines.push(`${grouped(c.rays_that_hit)} of ${plural(c.rays, "ray")} hit, ` +
               `${plural(c.ray_hits, "hit")} in all`);
  }
  if (c.boxes) {
    lines.push(`${plural(c.boxes, "box", "boxes")}: ${plural(c.inside, "object")} inside, ` +
               `${grouped(c.crossing)} crossing`);
  }
  const paragraph = caption.querySelector("p");
  paragraph.replaceChildren();
  lines.forEach((line) => {
    paragraph.append(line, document.createElement("br"));
  });
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
  const label = document.createElement("label");
  const box = document.createElement("input");
  box.type = "checkbox";
  box.checked = layer.shown;
  box.addEventListener("change", () => {
    kSwitched.set(layer.name, box.checked);
    layer.show(box.checked);
    drawSoon();
  });
  const swatch = document.createElement("span");
  swatch.className = `swatch ${layer.mark}`;
  swatch.style.background = swatch.style.borderColor = `rgb(${layer.colour.join(",")})`;
  const count = document.createElement("span");
  count.className = "count";
  count.textContent = grouped(layer.count);
  label.append(box, swatch, layer.name, count);
  return label;
}

// The opacity of faces of objects that the user chose, or null.
let chosenFill = null;
function solidity() {
  const label = document.createElement("label");
  const range = document.createElement("input");
  Object.assign(range, {type: "range", min: 0, max: 1, step: 0.01});
  const faces = kLayers.filter((l) => l.group === "Objects" && l.mark === "fill")
                    .map((l) => l.meshes[0]);
  const fill = (value) => {
    for (const mesh of faces) {
      mesh.material.uniforms.opacity.value = value;
      mesh.material.depthWrite = value === 1;
    }
  };
  if (chosenFill !== null) fill(chosenFill);
  range.value = faces.length ? faces[0].material.uniforms.opacity.value : 0;
  range.addEventListener("input", () => {
    chosenFill = Number(range.value);
    fill(chosenFill);
    drawSoon();
  });
  label.append("fill", range);
  return label;
}

function writeLegend() {
  const legend = document.getElementById("legend");
  legend.replaceChildren();
  for (const group of ["Objects", "Structure", "Queries"]) {
    const layers = kLayers.filter((layer) => layer.group === group);
    if (layers.length === 0) continue;
    const heading = document.createElement("h2");
    heading.textContent = group;
    legend.append(heading, ...layers.map(entryFor));
    if (group === "Objects") legend.append(solidity());
  }
  const reset = document.createElement("button");
  reset.textContent = "reset the view";
  reset.addEventListener("click", resetView);
  const hint = document.createElement("p");
  hint.textContent = "Drag to turn, right-drag to move, wheel to zoom. Point at an object or click it.";
  legend.append(reset, hint);
}
