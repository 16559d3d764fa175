// Builds the layers of the picture, which the legend switches on and off.

// The palette of Okabe and Ito, which is safe for colour-blind readers; also used by
// partitions/debug_colours.h.
const kColours = {
  object: [160, 168, 178],
  paired: [230, 159, 0],
  pair: [255, 214, 130],
  ray: [240, 240, 240],
  hit: [213, 94, 0],
  box: [204, 121, 167],
  chosen: [255, 255, 255],
  contact: [220, 50, 32],
};

const kScene = new THREE.Scene();
const kLayers = [];
const kLabels = [];
const kSwitched = new Map();  // layer name -> on or off, for layers that the user switched

// Adds a layer unless it is empty. `count` is the number in the legend, `counted` the mesh that
// draws that number of things, and `id` the name of the number in the counts of the tool.
function addLayer({meshes, counted = meshes[0], mark = "box", shown = true, ...facts}) {
  if (facts.count === 0) return;
  for (const mesh of meshes) if (mesh.isObject3D) kScene.add(mesh);
  const layer = {meshes, counted, mark, shown, ...facts};
  layer.show = (on) => {
    layer.shown = on;
    for (const mesh of meshes) mesh.visible = on;
  };
  layer.show(kSwitched.has(layer.name) ? kSwitched.get(layer.name) : shown);
  kLayers.push(layer);
}

function boxesAt(places) {
  const boxes = new Float32Array(6 * places.length);
  places.forEach((place, i) => {
    boxes.set(now.placed.subarray(6 * place, 6 * place + 6), 6 * i);
  });
  return boxes;
}

// Draws large numbers of things fainter, so that things behind them remain visible.
const thinned = (opacity, count) => Math.max(0.05, opacity * Math.min(1, Math.sqrt(500 / count)));

function addObjects() {
  const paired = new Uint8Array(now.objects.count);
  for (const place of now.pairs) paired[place] = 1;
  const places = [[], []];
  for (let i = 0; i < now.objects.count; ++i) places[paired[i]].push(i);
  const names = ["touch nothing", "in a pair"];
  [kColours.object, kColours.paired].forEach((colour, which) => {
    const boxes = boxesAt(places[which]);
    // Orange edges are sufficient; orange faces would hide the chosen object.
    const fill = colour.map((c, k) => 0.45 * c + 0.55 * kColours.object[k]);
    addLayer({
      id: "objects_drawn",
      paired: which === 1,
      group: "Objects",
      name: names[which],
      colour,
      count: places[which].length,
      mark: "fill",
      meshes: [boxFaces(boxes, fill, 1, 1), boxEdges(boxes, colour, 0.9, 3)],
    });
  });
}

const withGhost = (mesh, kind, opacity) => [mesh, ghost(mesh, kind, opacity)];

function addPairs() {
  const ends = new Float32Array(3 * now.pairs.length);
  for (let i = 0; i < now.pairs.length; ++i) {
    for (let axis = 0; axis < 3; ++axis) ends[3 * i + axis] = centreOfObject(now.pairs[i], axis);
  }
  const count = now.pairs.length / 2;
  addLayer({
    id: "pairs_drawn", group: "Objects", name: "pairs", colour: kColours.pair, count,
    mark: "line", shown: count <= 100000,
    meshes: withGhost(wideLines(ends, kColours.pair, 1, 1.6, 5), "lines", thinned(0.8, count)),
  });
}

function addContacts() {
  const ends = placedColumn(floatsOf(now.picture.contacts));
  const points = new Float32Array(ends.length / 2);
  for (let i = 0; i < points.length; ++i) points[i] = ends[6 * Math.floor(i / 3) + i % 3];
  const colour = kColours.contact;
  const count = ends.length / 6;
  addLayer({
    id: "contacts", group: "Objects", name: "contacts", colour, count, mark: "line",
    meshes: [...withGhost(wideLines(ends, colour, 1, 2.2, 7), "lines", 0.6),
             dots(points, colour, 7, 8)],
  });
}

// Name of the partition's cells in the legend.
const kCell = kPictures[0].counts.partition === "SweepAndPrune" ? "strip" : "cell";

function addStructure() {
  let budget = 4000;  // at most this many boxes can be distinguished on a screen
  for (const layer of now.picture.structure.layers) {
    const boxes = placedColumn(floatsOf(layer.boxes));
    const lines = placedColumn(floatsOf(layer.lines));
    const count = boxes.length / 6;
    const meshes = [];
    if (lines.length) {
      meshes.push(...withGhost(wideLines(lines, layer.colour, 1, 2.4, 6), "lines", 0.6));
    }
    if (count) {
      const edges = boxEdges(boxes, layer.colour, 1, 4);
      meshes.push(...withGhost(edges, "edges", thinned(0.35, count)));
    }
    const shown = count <= budget && layer.name !== "contents of cells";
    if (shown) budget -= count;
    addLayer({
      id: "structure_lines", part: count ? layer.name : "", group: "Structure",
      name: layer.name.replace("cell", kCell),
      colour: layer.colour,
      count: count || lines.length / 6, mark: count ? "box" : "line", shown, meshes,
    });
  }
}

const unique = (places) => [...new Set(places)].sort((a, b) => a - b);

// Returns the ray parameter up to which a ray is drawn: past the frame and past its last hit.
function endOfRay(ray) {
  const o = [0, 1, 2].map((axis) => (ray.origin[axis] - kFrame.centre[axis]) / kFrame.radius);
  const d = Array.from(ray.direction, (x) => x / kFrame.radius);
  const dd = d.reduce((sum, x) => sum + x * x, 0);
  const middle = -o.reduce((sum, x, axis) => sum + x * d[axis], 0) / dd;
  const apart = o.reduce((sum, x, axis) => sum + (x + middle * d[axis]) ** 2, 0);
  const half = Math.sqrt(Math.max(0, 1.3 ** 2 - apart) / dd);
  const last = ray.t.length ? ray.t[ray.t.length - 1] : 0;
  return Math.max(middle + half, 1.05 * last, 0.3 / Math.sqrt(dd));
}

const pointOn = (ray, t) => [0, 1, 2].map(
    (axis) => placed(ray.origin[axis] + t * ray.direction[axis], axis));

function addRays() {
  const colour = kColours.hit;
  const ends = now.rays.flatMap((ray) => [...pointOn(ray, 0), ...pointOn(ray, endOfRay(ray))]);
  const lines = new Float32Array(ends);
  const starts = new Float32Array(now.rays.flatMap((ray) => pointOn(ray, 0)));
  addLayer({
    id: "rays", group: "Queries", name: "rays", colour: kColours.ray, count: now.rays.length,
    mark: "line",
    meshes: [...withGhost(wideLines(lines, kColours.ray, 1, 2.2, 7), "lines", 0.6),
             dots(starts, kColours.ray, 7, 8)],
  });
  const closest = now.rays.filter((ray) => ray.closest !== undefined);
  const points = closest.flatMap((ray) => pointOn(ray, ray.closestT));
  const closestDots = dots(new Float32Array(points), colour, 13, 9);
  const first = boxesAt(unique(closest.map((ray) => ray.closest)));
  addLayer({
    id: "rays_that_hit", group: "Queries", name: "closest hits", colour, count: closest.length,
    mark: "fill",
    meshes: [boxFaces(first, colour, 0.75, 4),
             ...withGhost(boxEdges(first, colour, 1, 7), "edges", 0.9),
             closestDots],
    counted: closestDots,
  });
  const all = now.rays.flatMap((ray) => Array.from(ray.t, (t) => pointOn(ray, t))).flat();
  const allDots = dots(new Float32Array(all), colour, 8, 8);
  const hits = boxesAt(unique(now.rays.flatMap((ray) => Array.from(ray.hits))));
  addLayer({
    id: "ray_hits", group: "Queries", name: "all hits", colour, count: all.length / 3,
    meshes: [boxFaces(hits, colour, 0.4, 4),
             ...withGhost(boxEdges(hits, colour, 1, 6), "edges", 0.7),
             allDots],
    counted: allDots,
  });
}

function addQuestionBoxes() {
  const colour = kColours.box;
  const boxes = placedColumn(now.questionBoxes.flatMap((question) => Array.from(question.box)));
  addLayer({
    id: "boxes", group: "Queries", name: "boxes of queries", colour,
    count: now.questionBoxes.length,
    meshes: [boxFaces(boxes, colour, 0.12, 5),
             ...withGhost(boxEdges(boxes, colour, 1, 7), "edges", 0.7)],
  });
  for (const [id, name, opacity] of [["inside", "inside of a box", 0.6],
                                     ["crossing", "crossing its border", 0.25]]) {
    const places = now.questionBoxes.flatMap((question) => Array.from(question[id]));
    const found = boxesAt(unique(places));
    addLayer({
      id, group: "Queries", name, colour, count: places.length, mark: "fill",
      meshes: [boxFaces(found, colour, opacity, 4),
               ...withGhost(boxEdges(found, colour, 1, 6), "edges", 0.6)],
    });
  }
}

// Client data are a text layer of their own; labels of the structure belong to its layer.
function addLabels() {
  const labels = now.picture.structure.texts.slice(0, 500).map((text) => {
    const element = document.createElement("span");
    element.textContent = text.text;
    element.style.color = `rgb(${text.colour.join(",")})`;
    document.getElementById("labels").append(element);
    return {element, at: new THREE.Vector3(...placedColumn(floatsOf(text.at))), visible: true,
            layer: kLayers.find((l) => l.colour.join() === text.colour.join())};
  });
  kLabels.push(...labels);
  const names = labels.filter((label) => !label.layer);
  addLayer({
    id: "labels", group: "Objects", name: "client data", colour: [232, 232, 232],
    count: names.length, meshes: names, mark: "line", shown: names.length <= 100,
  });
}

function removeLayers() {
  for (const layer of kLayers.splice(0)) {
    for (const mesh of layer.meshes) {
      if (!mesh.isObject3D) continue;
      kScene.remove(mesh);
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
  }
  kLabels.length = 0;
  document.getElementById("labels").replaceChildren();
}

function addLayers() {
  addObjects();
  addPairs();
  addContacts();
  addStructure();
  addRays();
  addQuestionBoxes();
  addLabels();
}
