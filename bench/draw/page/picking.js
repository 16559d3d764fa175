// Finds the object under the pointer: the first visible one on a ray from the eye.

const kChosen = {place: -1, pinned: false, mesh: null};

// Returns whether the layers of objects without and with a pair are shown.
function pickable() {
  const shown = (paired) => kLayers.some((l) => l.paired === paired && l.shown);
  return [shown(false), shown(true)];
}

function entry(boxes, place, eye, direction) {
  let from = 0;
  let to = Infinity;
  for (let axis = 0; axis < 3; ++axis) {
    const inverse = 1 / direction[axis];
    const a = (boxes[6 * place + axis] - eye[axis]) * inverse;
    const b = (boxes[6 * place + 3 + axis] - eye[axis]) * inverse;
    from = Math.max(from, Math.min(a, b));
    to = Math.min(to, Math.max(a, b));
  }
  return from <= to ? from : Infinity;
}

function objectAt(x, y) {
  const pointer = new THREE.Vector3(2 * x / window.innerWidth - 1, 1 - 2 * y / window.innerHeight, 0.5);
  const eye = kCamera.position.toArray();
  const direction = pointer.unproject(kCamera).sub(kCamera.position).normalize().toArray();
  let best = -1;
  let nearest = Infinity;
  const shown = pickable();
  for (let place = 0; place < now.objects.count; ++place) {
    const t = entry(now.placed, place, eye, direction);
    // Skips boxes that contain the eye: they would hide everything, and are seldom the target.
    if (t > 0 && t < nearest && shown[Number(now.partners.has(place))]) {
      nearest = t;
      best = place;
    }
  }
  return best;
}

function choose(place) {
  if (place === kChosen.place) return;
  kChosen.place = place;
  if (kChosen.mesh) kScene.remove(kChosen.mesh);
  kChosen.mesh = null;
  if (place >= 0) {
    kChosen.mesh = boxEdges(boxesAt([place]), kColours.chosen, 1, 10);
    kScene.add(kChosen.mesh);
  }
  showInfo(place);
  drawSoon();
}

function rowsText(places) {
  const rows = places.slice(0, 8).map((p) => now.objects.rows[p]).join(", ");
  return places.length > 8 ? `${rows} and ${places.length - 8} more` : rows;
}

function factsOf(place) {
  const box = Array.from(now.objects.boxes.subarray(6 * place, 6 * place + 6),
                         (x) => Number(x.toPrecision(7)).toString());
  const facts = [
    ["row", now.objects.rows[place]],
    ["client data", now.objects.data[place].toString()],
    ["from", box.slice(0, 3).join(", ")],
    ["to", box.slice(3).join(", ")],
    ["overlaps rows", rowsText(now.partners.get(place) || []) || "none"],
  ];
  now.rays.forEach((ray, i) => {
    const at = ray.hits.indexOf(place);
    if (at < 0) return;
    facts.push([`ray ${i + 1}`, `t = ${Number(ray.t[at].toPrecision(7))}` +
                                (ray.closest === place ? ", the closest" : "")]);
  });
  now.questionBoxes.forEach((question, i) => {
    if (question.inside.includes(place)) facts.push([`box ${i + 1}`, "inside"]);
    if (question.crossing.includes(place)) facts.push([`box ${i + 1}`, "crossing"]);
  });
  return facts;
}

function showInfo(place) {
  const info = document.getElementById("info");
  info.hidden = place < 0;
  if (place < 0) return;
  const table = document.createElement("table");
  for (const [name, value] of factsOf(place)) {
    const row = table.insertRow();
    const head = document.createElement("th");
    head.textContent = name;
    row.append(head);
    row.insertCell().textContent = value;
  }
  info.replaceChildren(table);
}

function startPicking() {
  let pressed = null;
  let due = false;
  kCanvas.addEventListener("pointerdown", (e) => { pressed = [e.clientX, e.clientY]; });
  window.addEventListener("pointerup", (e) => {
    const click = pressed && Math.hypot(e.clientX - pressed[0], e.clientY - pressed[1]) < 4;
    pressed = null;
    if (!click) return;
    const place = objectAt(e.clientX, e.clientY);
    kChosen.pinned = place >= 0;
    choose(place);
  });
  kCanvas.addEventListener("pointermove", (e) => {
    if (pressed || kChosen.pinned || due) return;
    due = true;
    requestAnimationFrame(() => {
      due = false;
      choose(objectAt(e.clientX, e.clientY));
    });
  });
}
