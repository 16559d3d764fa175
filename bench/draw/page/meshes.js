// Meshes of a layer: boxes (edges and faces), lines with a width in pixels, and dots. Things far
// behind the middle fade into the background.

const kBackground = 0x12161c;
const kScene = new THREE.Scene();
kScene.fog = new THREE.Fog(kBackground);
// The fog leaves everything visible.
THREE.ShaderChunk.fog_fragment =
    THREE.ShaderChunk.fog_fragment.replace("fogFactor )", "0.7 * fogFactor )");
const kLight = new THREE.HemisphereLight(0xffffff, 0x000000, 0.8);
kLight.position.set(0.3, -0.5, 0.8);
kScene.add(kLight);

// What all materials have in common.
const materialOf = (colour, opacity, more) => ({
  color: new THREE.Color(...colour.map((c) => c / 255)), opacity, transparent: true,
  depthWrite: false, side: THREE.DoubleSide, ...more,
});

function finished(mesh, order) {
  mesh.frustumCulled = false;
  mesh.renderOrder = order;
  return mesh;
}

// The corners at which the edges of a box end: bit `axis` is set at the upper end.
const kEdgeCorners = [];
for (let corner = 0; corner < 8; ++corner) {
  for (const bit of [1, 2, 4]) if (!(corner & bit)) kEdgeCorners.push(corner, corner | bit);
}

// `boxes`: six placed floats per box.
function boxEdges(boxes, colour, opacity, order) {
  const ends = new Float32Array(12 * boxes.length);
  for (let i = 0; i < ends.length; ++i) {
    const axis = i % 3;
    const corner = kEdgeCorners[Math.floor(i / 3) % 24];
    ends[i] = boxes[6 * Math.floor(i / 72) + axis + 3 * (corner >> axis & 1)];
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(ends, 3));
  const material = new THREE.LineBasicMaterial(materialOf(colour, opacity));
  return finished(new THREE.LineSegments(geometry, material), order);
}

function boxFaces(boxes, colour, opacity, order) {
  const material = new THREE.MeshLambertMaterial(materialOf(colour, opacity, {
    depthWrite: opacity === 1, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
  }));
  const count = boxes.length / 6;
  const mesh = new THREE.InstancedMesh(new THREE.BoxBufferGeometry(1, 1, 1), material, count);
  const matrices = mesh.instanceMatrix.array;
  for (let i = 0; i < count; ++i) {
    for (let axis = 0; axis < 3; ++axis) {
      const [low, high] = [boxes[6 * i + axis], boxes[6 * i + 3 + axis]];
      matrices[16 * i + 5 * axis] = Math.max(1e-6, high - low);  // a flat box has normals, too
      matrices[16 * i + 12 + axis] = 0.5 * (low + high);
    }
    matrices[16 * i + 15] = 1;
  }
  return finished(mesh, order);
}

// Wide lines have their opacity, and the size of the window, in uniforms.
const kResolution = new THREE.Vector2(1, 1);
function setUniforms(material, opacity) {
  material.uniforms.opacity.value = opacity;
  material.uniforms.resolution.value = kResolution;
}

// `ends`: six placed floats per line.
function wideLines(ends, colour, opacity, width, order) {
  const geometry = new THREE.LineSegmentsGeometry().setPositions(ends);
  const material = new THREE.LineMaterial(materialOf(colour, opacity, {linewidth: width, fog: true}));
  setUniforms(material, opacity);
  return finished(new THREE.LineSegments2(geometry, material), order);
}

// Discs with a white core.
function dots(points, colour, size, order) {
  const disc = make("canvas", {width: 32, height: 32});
  const pen = disc.getContext("2d");
  for (const [fill, radius] of [[`rgb(${colour})`, 16], ["white", 7]]) {
    pen.fillStyle = fill;
    pen.arc(16, 16, radius, 0, 7);
    pen.fill();
    pen.beginPath();
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
  const material = new THREE.PointsMaterial(materialOf([255, 255, 255], 1, {
    map: new THREE.CanvasTexture(disc), size, sizeAttenuation: false, depthTest: false, fog: false,
  }));
  return finished(new THREE.Points(geometry, material), order);
}

// Returns the mesh, and a copy that draws its parts behind solid objects fainter.
function withGhost(mesh, opacity) {
  const material = Object.assign(mesh.material.clone(), {opacity, depthFunc: THREE.GreaterDepth});
  if (material.isLineMaterial) setUniforms(material, opacity);
  return [mesh, finished(new mesh.constructor(mesh.geometry, material), mesh.renderOrder)];
}

// Returns the number of boxes, lines or dots that a mesh sends to the GPU.
function drawnBy(mesh) {
  const {instanceStart, position} = mesh.geometry.attributes;
  if (mesh.isInstancedMesh) return mesh.count;
  if (instanceStart) return instanceStart.count;
  return position.count / (mesh.isLineSegments ? 24 : 1);
}
