// The pictures that the tool wrote, one per frame. Columns are base64 of little-endian values.

const kPictures = JSON.parse(document.getElementById("data").textContent);

const kColumns = {
  boxes: Float32Array, lines: Float32Array, contacts: Float32Array,
  ray: Float32Array, box: Float32Array, t: Float32Array, rows: Uint32Array, pairs: Uint32Array,
  hits: Uint32Array, inside: Uint32Array, crossing: Uint32Array,
};
const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;

// Decodes the columns of a picture, or of a part of it. A box is six floats: the lower corner, then
// the upper one; a ray is its origin, then its direction.
function decoded(part, name) {
  if (typeof part === "string") {
    return name in kColumns ? new kColumns[name](bytesOf(part)) : part;
  }
  if (Array.isArray(part)) return part.map((one) => decoded(one));
  if (typeof part !== "object") return part;
  return Object.fromEntries(Object.entries(part).map(([key, value]) => [key, decoded(value, key)]));
}

// Maps the index of each object that has a pair to the indices of its partners.
function partnersOf(pairs) {
  const partners = new Map();
  for (let i = 0; i < pairs.length; i += 2) {
    for (const [a, b] of [[pairs[i], pairs[i + 1]], [pairs[i + 1], pairs[i]]]) {
      if (!partners.has(a)) partners.set(a, []);
      partners.get(a).push(b);
    }
  }
  return partners;
}

// Returns the box that the camera shows. It contains the middle 96 % of the ends of all boxes and
// extends past them by at most half of their range, so that one box far away does not shrink all
// others to a dot.
function frameOf(boxes) {
  const low = [0, 0, 0];
  const high = [0, 0, 0];
  const at = (column, share) => column[Math.round(share * (column.length - 1))];
  for (let axis = 0; axis < 3; ++axis) {
    let [lows, highs] = [axis, axis + 3].map(
        (end) => boxes.filter((x, i) => i % 6 === end && Number.isFinite(x)).sort());
    if (lows.length === 0) lows = highs.length ? highs : [-1, 1];
    if (highs.length === 0) highs = lows;
    const from = at(lows, 0.02);
    const to = at(highs, 0.98);
    const margin = 0.5 * Math.abs(to - from);
    low[axis] = Math.max(lows[0], from - margin);
    high[axis] = Math.min(at(highs, 1), to + margin);
    if (low[axis] > high[axis]) [low[axis], high[axis]] = [high[axis], low[axis]];
  }
  const centre = low.map((l, axis) => 0.5 * l + 0.5 * high[axis]);
  const radius = Math.hypot(...low.map((l, axis) => 0.5 * high[axis] - 0.5 * l)) || 1;
  return {low, high, centre, radius};
}

// The GPU gets coordinates relative to the frame's centre, in units of its radius, so that floats
// far from the origin, very large or very small lose no precision. All pictures use the frame of
// the first one, so that motion is visible.
const kFrame = frameOf(decoded(kPictures[0]).objects.boxes);
const kFarthest = 40;

// Ends at infinity are drawn slightly outside of the frame.
function placed(value, axis) {
  const c = kFrame.centre[axis];
  const r = kFrame.radius;
  if (value === -Infinity) return (kFrame.low[axis] - c) / r - 0.15;
  if (value === Infinity) return (kFrame.high[axis] - c) / r + 0.15;
  return Math.min(kFarthest, Math.max(-kFarthest, (value - c) / r));
}
const placedColumn = (values) => Float32Array.from(values, (value, i) => placed(value, i % 3));

// The picture of the frame that is shown. The tool names objects by their rows, and the page by
// their places among the drawn ones.
let now;
function show(picture) {
  now = decoded(picture);
  const placeOf = new Map(Array.from(now.objects.rows, (row, place) => [row, place]));
  const places = (rows) => rows.map((row) => placeOf.get(row));
  for (const ray of now.rays) {
    Object.assign(ray, {hits: places(ray.hits), closest: placeOf.get(ray.closest)});
  }
  for (const box of now.boxes) {
    Object.assign(box, {inside: places(box.inside), crossing: places(box.crossing)});
  }
  now.pairs = places(now.pairs);
  now.partners = partnersOf(now.pairs);
  now.placed = placedColumn(now.objects.boxes);
}
show(kPictures[0]);

const centreOfObject = (i, axis) => 0.5 * (now.placed[6 * i + axis] + now.placed[6 * i + 3 + axis]);
