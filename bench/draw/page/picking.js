// Finds the object under the pointer: the first visible one on a ray from the eye.

const kChosen = {place: -1, pinned: false, mesh: null};

function objectAt(x, y) {
  const pointer = {x: 2 * x / window.innerWidth - 1, y: 1 - 2 * y / window.innerHeight};
  const caster = new THREE.Raycaster();
  caster.setFromCamera(pointer, kCamera);
  const {ray} = caster;
  // Whether the layers of objects without and with a pair are shown.
  const shown = [false, true].map((paired) => kLayers.some((l) => l.paired === paired && l.shown));
  let best = -1;
  let nearest = Infinity;
  const box = new THREE.Box3();
  const point = new THREE.Vector3();
  for (let place = 0; place < now.objects.rows.length; ++place) {
    box.min.fromArray(now.placed, 6 * place);
    box.max.fromArray(now.placed, 6 * place + 3);
    // Skips boxes that contain the eye: they would hide everything, and are seldom the target.
    if (!shown[Number(now.partners.has(place))] || box.containsPoint(ray.origin)) continue;
    if (ray.intersectBox(box, point) === null) continue;
    const distance = point.distanceToSquared(ray.origin);
    if (distance >= nearest) continue;
    nearest = distance;
    best = place;
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
  now.boxes.forEach((question, i) => {
    if (question.inside.includes(place)) facts.push([`box ${i + 1}`, "inside"]);
    if (question.crossing.includes(place)) facts.push([`box ${i + 1}`, "crossing"]);
  });
  return facts;
}

function showInfo(place) {
  const info = document.getElementById("info");
  info.hidden = place < 0;
  if (place < 0) return;
  info.replaceChildren(make("table", {}, ...factsOf(place).map(([name, value]) =>
    make("tr", {}, make("th", {textContent: name}), make("td", {textContent: value})))));
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
