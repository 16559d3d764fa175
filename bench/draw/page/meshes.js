// Meshes of a layer: instanced boxes (edges and faces), lines with a width in pixels, and dots.
// Each takes one draw call, whatever the number of instances.

const kUniforms = {
  resolution: {value: new THREE.Vector2(1, 1)},
  pixelRatio: {value: 1},
  // Distance of the camera from its target; things behind the target fade.
  reach: {value: 3},
};

const kVertexStart = `
precision highp float;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform vec2 resolution;
uniform float pixelRatio;
uniform float reach;
uniform float width;
varying float shade;
float fade(float distance) { return mix(1.0, 0.3, clamp((distance - reach + 0.9) / 1.8, 0.0, 1.0)); }
`;

const kVertexShaders = {
  edges: `
attribute vec3 position, low, high;
void main() {
  vec4 seen = modelViewMatrix * vec4(mix(low, high, position), 1.0);
  shade = fade(-seen.z);
  gl_Position = projectionMatrix * seen;
}`,
  faces: `
attribute vec3 position, normal, low, high;
void main() {
  vec4 seen = modelViewMatrix * vec4(mix(low, high, position), 1.0);
  vec3 n = (modelViewMatrix * vec4(normal, 0.0)).xyz;
  shade = (0.4 + 0.6 * fade(-seen.z)) * (0.2 + 0.5 * abs(dot(n, normalize(vec3(0.3, 0.5, 0.8)))));
  gl_Position = projectionMatrix * seen;
}`,
  lines: `
attribute vec3 position, from, to;
void main() {
  vec4 seenA = modelViewMatrix * vec4(from, 1.0);
  vec4 seenB = modelViewMatrix * vec4(to, 1.0);
  float near = -0.001;
  if (seenA.z > near && seenB.z < near) seenA = mix(seenA, seenB, (near - seenA.z) / (seenB.z - seenA.z));
  if (seenB.z > near && seenA.z < near) seenB = mix(seenB, seenA, (near - seenB.z) / (seenA.z - seenB.z));
  vec4 a = projectionMatrix * seenA;
  vec4 b = projectionMatrix * seenB;
  vec2 along = (b.xy / b.w - a.xy / a.w) * resolution;
  vec2 across = length(along) > 0.0 ? normalize(vec2(-along.y, along.x)) : vec2(0.0, 1.0);
  vec4 end = mix(a, b, position.x);
  end.xy += across * position.y * width * pixelRatio / resolution * end.w;
  shade = fade(-mix(seenA.z, seenB.z, position.x));
  gl_Position = end;
}`,
  dots: `
attribute vec3 position;
void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  shade = 1.0;
  gl_PointSize = width * pixelRatio;
  gl_Position = projectionMatrix * seen;
}`,
};

const kFragmentShaders = {
  faces: `
precision highp float;
uniform vec3 colour;
uniform float opacity;
varying float shade;
void main() { gl_FragColor = vec4(mix(vec3(0.07, 0.086, 0.11), colour, shade), opacity); }`,
  plain: `
precision highp float;
uniform vec3 colour;
uniform float opacity;
varying float shade;
void main() { gl_FragColor = vec4(colour, opacity * shade); }`,
  dots: `
precision highp float;
uniform vec3 colour;
uniform float opacity;
varying float shade;
void main() {
  float r = length(gl_PointCoord - 0.5) * 2.0;
  if (r > 1.0) discard;
  gl_FragColor = vec4(mix(colour, vec3(1.0), step(r, 0.45)), opacity * shade);
}`,
};

// A material for things that are visible, or with `hidden` for things behind solid objects, which
// are drawn a second time and fainter.
function material(kind, colour, opacity, width, hidden) {
  return new THREE.RawShaderMaterial({
    uniforms: {
      ...kUniforms,
      colour: {value: new THREE.Color(...colour.map((c) => c / 255))},
      opacity: {value: opacity},
      width: {value: width || 1},
    },
    vertexShader: kVertexStart + kVertexShaders[kind],
    fragmentShader: kFragmentShaders[kind] || kFragmentShaders.plain,
    transparent: true,
    depthTest: kind !== "dots",
    depthFunc: hidden ? THREE.GreaterDepth : THREE.LessEqualDepth,
    depthWrite: kind === "faces" && opacity === 1,
    polygonOffset: kind === "faces",
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
    side: THREE.DoubleSide,
  });
}

const kCorners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1, (i >> 1) & 1, (i >> 2) & 1]);
const kEdgeVertices = [];
for (let a = 0; a < 8; ++a) {
  for (const bit of [1, 2, 4]) {
    if (!(a & bit)) kEdgeVertices.push(...kCorners[a], ...kCorners[a | bit]);
  }
}
const kFaceVertices = [];
const kFaceNormals = [];
for (let axis = 0; axis < 3; ++axis) {
  for (const side of [0, 1]) {
    for (const [u, v] of [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]]) {
      const corner = [0, 0, 0];
      corner[axis] = side;
      corner[(axis + 1) % 3] = u;
      corner[(axis + 2) % 3] = v;
      const normal = [0, 0, 0];
      normal[axis] = 1;
      kFaceVertices.push(...corner);
      kFaceNormals.push(...normal);
    }
  }
}

function instanced(vertices, count, first, second, columns) {
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(vertices), 3));
  const buffer = new THREE.InstancedInterleavedBuffer(columns, 6, 1);
  geometry.setAttribute(first, new THREE.InterleavedBufferAttribute(buffer, 3, 0));
  geometry.setAttribute(second, new THREE.InterleavedBufferAttribute(buffer, 3, 3));
  // The name of this member depends on the version of three.js.
  geometry.maxInstancedCount = count;
  geometry.instanceCount = count;
  return geometry;
}

function finished(mesh, order) {
  mesh.frustumCulled = false;
  mesh.renderOrder = order;
  return mesh;
}

// `boxes`: six placed floats per box.
function boxEdges(boxes, colour, opacity, order) {
  const geometry = instanced(kEdgeVertices, boxes.length / 6, "low", "high", boxes);
  const lines = new THREE.LineSegments(geometry, material("edges", colour, opacity));
  return finished(lines, order);
}

function boxFaces(boxes, colour, opacity, order) {
  const geometry = instanced(kFaceVertices, boxes.length / 6, "low", "high", boxes);
  geometry.setAttribute("normal",
                        new THREE.BufferAttribute(new Float32Array(kFaceNormals), 3));
  return finished(new THREE.Mesh(geometry, material("faces", colour, opacity)), order);
}

// `ends`: six placed floats per line.
function wideLines(ends, colour, opacity, width, order) {
  const quad = [0, -1, 0, 1, -1, 0, 1, 1, 0, 0, -1, 0, 1, 1, 0, 0, 1, 0];
  const geometry = instanced(quad, ends.length / 6, "from", "to", ends);
  return finished(new THREE.Mesh(geometry, material("lines", colour, opacity, width)), order);
}

// Returns a copy of the mesh that draws only the parts behind solid objects.
function ghost(mesh, kind, opacity) {
  const {colour, width} = mesh.material.uniforms;
  const rgb = colour.value.toArray().map((c) => 255 * c);
  const faint = material(kind, rgb, opacity, width.value, true);
  const copy = mesh.isLineSegments ? new THREE.LineSegments(mesh.geometry, faint)
                                   : new THREE.Mesh(mesh.geometry, faint);
  return finished(copy, mesh.renderOrder);
}

function dots(points, colour, size, order) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
  return finished(new THREE.Points(geometry, material("dots", colour, 1, size)), order);
}

// Returns the number of boxes, lines or dots that a mesh sends to the GPU.
function drawnBy(mesh) {
  const geometry = mesh.geometry;
  return geometry.isInstancedBufferGeometry ? geometry.maxInstancedCount
                                            : geometry.attributes.position.count;
}
