// The pictures that the tool wrote, one per frame. Columns are base64 of little-endian values.

const kPictures = JSON.parse(document.getElementById("data").textContent);

function bytesOf(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes.buffer;
}

const floatsOf = (text) => new Float32Array(bytesOf(text));
const indicesOf = (text) => new Uint32Array(bytesOf(text));
const wideOf = (text) => new BigUint64Array(bytesOf(text));

// Decodes one picture. A box is six floats: the lower corner, then the upper one.
function read(picture) {
  const objects = {
    boxes: floatsOf(picture.objects.boxes),
    rows: indicesOf(picture.objects.rows),
    data: wideOf(picture.objects.data),
  };
  objects.count = objects.rows.length;
  const rays = picture.rays.map((r) => {
    const ray = floatsOf(r.ray);
    return {
      origin: ray.slice(0, 3),
      direction: ray.slice(3, 6),
      closest: r.closest,
      closestT: r.closest_t,
      hits: indicesOf(r.hits),
      t: floatsOf(r.t),
    };
  });
  const questionBoxes = picture.boxes.map((b) => ({
    box: floatsOf(b.box),
    inside: indicesOf(b.inside),
    crossing: indicesOf(b.crossing),
  }));
  const pairs = indicesOf(picture.pairs);
  return {picture, objects, pairs, rays, questionBoxes, partners: partnersOf(pairs)};
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

// The decoded picture of the frame that is shown.
let now = read(kPictures[0]);

// Returns the box that the camera shows. It contains the middle 96 % of the ends of all boxes and
// extends past them by at most half of their range, so that one box far away does not shrink all
// others to a dot.
function findFrame() {
  const low = [0, 0, 0];
  const high = [0, 0, 0];
  for (let axis = 0; axis < 3; ++axis) {
    let ends = [new Float32Array(now.objects.count), new Float32Array(now.objects.count)];
    for (let i = 0; i < now.objects.count; ++i) {
      ends[0][i] = now.objects.boxes[6 * i + axis];
      ends[1][i] = now.objects.boxes[6 * i + 3 + axis];
    }
    ends = ends.map((column) => column.filter(Number.isFinite).sort());
    const at = (column, share) => column[Math.round(share * (column.length - 1))];
    if (ends[0].length === 0 || ends[1].length === 0) {
      low[axis] = ends[0].length ? ends[0][0] : ends[1].length ? ends[1][0] : -1;
      high[axis] = ends[1].length ? at(ends[1], 1) : ends[0].length ? at(ends[0], 1) : 1;
      continue;
    }
    const from = at(ends[0], 0.02);
    const to = at(ends[1], 0.98);
    const margin = 0.5 * Math.abs(to - from);
    low[axis] = Math.max(ends[0][0], from - margin);
    high[axis] = Math.min(at(ends[1], 1), to + margin);
    if (low[axis] > high[axis]) [low[axis], high[axis]] = [high[axis], low[axis]];
  }
  const centre = low.map((l, axis) => 0.5 * l + 0.5 * high[axis]);
  const radius = Math.hypot(...low.map((l, axis) => 0.5 * high[axis] - 0.5 * l)) || 1;
  return {low, high, centre, radius};
}

// The GPU gets coordinates relative to the frame's centre, in units of its radius, so that floats
// far from the origin, very large or very small lose no precision. All pictures use the frame of
// the first one, so that motion is visible.
const kFrame = now.objects.count ? findFrame() : {low: [-1, -1, -1], high: [1, 1, 1],
                                               centre: [0, 0, 0], radius: Math.sqrt(3)};
const kFarthest = 40;

// Ends at infinity are drawn slightly outside of the frame.
function placed(value, axis) {
  const c = kFrame.centre[axis];
  const r = kFrame.radius;
  if (value === -Infinity) return (kFrame.low[axis] - c) / r - 0.15;
  if (value === Infinity) return (kFrame.high[axis] - c) / r + 0.15;
  return Math.min(kFarthest, Math.max(-kFarthest, (value - c) / r));
}

function placedColumn(values) {
  const result = new Float32Array(values.length);
  for (let i = 0; i < values.length; ++i) result[i] = placed(values[i], i % 3);
  return result;
}

function show(picture) {
  now = read(picture);
  now.placed = placedColumn(now.objects.boxes);
}
now.placed = placedColumn(now.objects.boxes);

function centreOfObject(i, axis) {
  return 0.5 * (now.placed[6 * i + axis] + now.placed[6 * i + 3 + axis]);
}
