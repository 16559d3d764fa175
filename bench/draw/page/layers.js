// Builds the layers of the picture, which the legend switches on and off.

// The palette of Okabe and Ito, which is safe for colour-blind readers; also used by
// core/debug_draw.h.
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

const kLayers = [];
const kSwitched = new Map();  // layer name -> on or off, for layers that the user switched

// Adds a layer unless it is empty. `count` is the number in the legend, `counted` the mesh that
// draws that number of things, and `id` the name of the number in the counts of the tool.
function addLayer({meshes, counted = meshes[0], mark = "box", shown = true, ...facts}) {
  if (facts.count === 0) return;
  for (const mesh of meshes) kScene.add(mesh);
  const layer = {meshes, counted, mark, shown, ...facts};
  layer.show = (on) => {
    layer.shown = on;
    for (const mesh of meshes) mesh.visible = on;
  };
  layer.show(kSwitched.has(layer.name) ? kSwitched.get(layer.name) : shown);
  kLayers.push(layer);
}

// The boxes of objects, each once.
const boxesAt = (places) => Float32Array.from([...new Set(places)].flatMap(
    (place) => [...now.placed.subarray(6 * place, 6 * place + 6)]));

// Draws large numbers of things fainter, so that things behind them remain visible.
const thinned = (opacity, count) => Math.max(0.05, opacity * Math.min(1, Math.sqrt(500 / count)));

function addObjects() {
  const places = [[], []];
  now.objects.rows.forEach((row, i) => places[Number(now.partners.has(i))].push(i));
  const names = ["touch nothing", "in a pair"];
  [kColours.object, kColours.paired].forEach((colour, which) => {
    const boxes = boxesAt(places[which]);
    // Orange edges are sufficient; orange faces would hide the chosen object.
    const fill = colour.map((c, k) => 0.45 * c + 0.55 * kColours.object[k]);
    addLayer({
      id: "objects_drawn", paired: which === 1, group: "Objects", name: names[which], colour,
      count: places[which].length, mark: "fill",
      meshes: [boxFaces(boxes, fill, 1, 1), boxEdges(boxes, colour, 0.9, 3)],
    });
  });
}

// Boxes with filled faces, whose edges are seen through other objects.
const marked = (boxes, colour, fill, order, opacity) =>
    [boxFaces(boxes, colour, fill, 4), ...withGhost(boxEdges(boxes, colour, 1, order), opacity)];

function addPairs() {
  const ends = new Float32Array(3 * now.pairs.length);
  for (let i = 0; i < now.pairs.length; ++i) {
    for (let axis = 0; axis < 3; ++axis) ends[3 * i + axis] = centreOfObject(now.pairs[i], axis);
  }
  const count = now.pairs.length / 2;
  addLayer({
    id: "pairs_drawn", group: "Objects", name: "pairs", colour: kColours.pair, count,
    mark: "line", shown: count <= 100000,
    meshes: withGhost(wideLines(ends, kColours.pair, 1, 1.6, 5), thinned(0.8, count)),
  });
}

function addContacts() {
  const ends = placedColumn(now.contacts);
  const points = ends.filter((x, i) => i % 6 < 3);
  const colour = kColours.contact;
  const count = ends.length / 6;
  addLayer({
    id: "contacts", group: "Objects", name: "contacts", colour, count, mark: "line",
    meshes: [...withGhost(wideLines(ends, colour, 1, 2.2, 7), 0.6),
             dots(points, colour, 7, 8)],
  });
}

// Name of the partition's cells in the legend.
const kCell = kPictures[0].counts.partition === "SweepAndPrune" ? "strip" : "cell";

function addStructure() {
  let budget = 4000;  // at most this many boxes can be distinguished on a screen
  for (const layer of now.structure) {
    const boxes = placedColumn(layer.boxes);
    const lines = placedColumn(layer.lines);
    const count = boxes.length / 6;
    const meshes = [];
    if (lines.length) meshes.push(...withGhost(wideLines(lines, layer.colour, 1, 2.4, 6), 0.6));
    if (count) {
      meshes.push(...withGhost(boxEdges(boxes, layer.colour, 1, 4), thinned(0.35, count)));
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

// Returns the ray parameter up to which a ray is drawn: past the frame and past its last hit.
function endOfRay({ray, t}) {
  const distance = Math.hypot(...[0, 1, 2].map((axis) => ray[axis] - kFrame.centre[axis]));
  const past = (distance + 1.3 * kFrame.radius) / Math.hypot(...ray.subarray(3));
  return Math.max(past, 1.05 * (t[t.length - 1] || 0));
}

const pointOn = ({ray}, t) =>
    [0, 1, 2].map((axis) => placed(ray[axis] + t * ray[axis + 3], axis));

function addRays() {
  const colour = kColours.hit;
  const ends = now.rays.flatMap((ray) => [...pointOn(ray, 0), ...pointOn(ray, endOfRay(ray))]);
  const lines = new Float32Array(ends);
  const starts = new Float32Array(now.rays.flatMap((ray) => pointOn(ray, 0)));
  addLayer({
    id: "rays", group: "Queries", name: "rays", colour: kColours.ray, count: now.rays.length,
    mark: "line",
    meshes: [...withGhost(wideLines(lines, kColours.ray, 1, 2.2, 7), 0.6),
             dots(starts, kColours.ray, 7, 8)],
  });
  const closest = now.rays.filter((ray) => ray.closest !== undefined);
  const points = closest.flatMap((ray) => pointOn(ray, ray.closest_t));
  const closestDots = dots(new Float32Array(points), colour, 13, 9);
  const first = boxesAt(closest.map((ray) => ray.closest));
  addLayer({
    id: "rays_that_hit", group: "Queries", name: "closest hits", colour, count: closest.length,
    mark: "fill", meshes: [...marked(first, colour, 0.75, 7, 0.9), closestDots],
    counted: closestDots,
  });
  const all = now.rays.flatMap((ray) => Array.from(ray.t, (t) => pointOn(ray, t))).flat();
  const allDots = dots(new Float32Array(all), colour, 8, 8);
  const hits = boxesAt(now.rays.flatMap((ray) => [...ray.hits]));
  addLayer({
    id: "ray_hits", group: "Queries", name: "all hits", colour, count: all.length / 3,
    meshes: [...marked(hits, colour, 0.4, 6, 0.7), allDots], counted: allDots,
  });
}

function addQuestionBoxes() {
  const colour = kColours.box;
  const boxes = placedColumn(now.boxes.flatMap((question) => [...question.box]));
  addLayer({
    id: "boxes", group: "Queries", name: "boxes of queries", colour, count: now.boxes.length,
    meshes: marked(boxes, colour, 0.12, 7, 0.7),
  });
  for (const [id, name, opacity] of [["inside", "inside of a box", 0.6],
                                     ["crossing", "crossing its border", 0.25]]) {
    const places = now.boxes.flatMap((question) => [...question[id]]);
    addLayer({
      id, group: "Queries", name, colour, count: places.length, mark: "fill",
      meshes: marked(boxesAt(places), colour, opacity, 6, 0.6),
    });
  }
}

function removeLayers() {
  for (const layer of kLayers.splice(0)) {
    for (const mesh of layer.meshes) {
      kScene.remove(mesh);
      mesh.geometry.dispose();
      mesh.material.dispose();
      if (mesh.material.map) mesh.material.map.dispose();
    }
  }
}

function addLayers() {
  addObjects();
  addPairs();
  addContacts();
  addStructure();
  addRays();
  addQuestionBoxes();
}
