// The camera. Draws on demand only, so that an idle page costs nothing.

const kRenderer = new THREE.WebGLRenderer({antialias: true});
const kCamera = new THREE.PerspectiveCamera(32, 1, 0.001, 200);
const kCanvas = kRenderer.domElement;
const kControls = new THREE.OrbitControls(kCamera, kCanvas);

let drawingIsDue = false;

function drawSoon() {
  if (drawingIsDue) return;
  drawingIsDue = true;
  requestAnimationFrame(() => {
    drawingIsDue = false;
    draw();
  });
}

function draw() {
  const distance = kCamera.position.distanceTo(kControls.target);
  kScene.fog.near = distance - 0.9;
  kScene.fog.far = distance + 0.9;
  kCamera.near = Math.max(1e-4, distance / 500);
  kCamera.far = distance + 200;
  kCamera.updateProjectionMatrix();
  kRenderer.render(kScene, kCamera);
}

function fitWindow() {
  kRenderer.setPixelRatio(window.devicePixelRatio || 1);
  kRenderer.setSize(window.innerWidth, window.innerHeight);
  kResolution.set(window.innerWidth, window.innerHeight);
  kCamera.aspect = window.innerWidth / window.innerHeight;
  // Centres the picture in the area beside the panels.
  const legend = window.innerWidth > 700 ? 262 : 0;
  kCamera.setViewOffset(window.innerWidth, window.innerHeight, legend / 2, 0, window.innerWidth,
                        window.innerHeight);
  drawSoon();
}

// Looks from above a corner, at a distance that shows the whole frame.
function resetView() {
  const half = Math.tan(kCamera.fov * Math.PI / 360);
  const free = Math.max(0.4, (window.innerWidth - 262) / window.innerHeight);
  const distance = 1.08 / Math.sin(Math.atan(half * Math.min(1, free)));
  // Looks at the broad side of a thin scene.
  const extent = kFrame.high.map((high, axis) => high - kFrame.low[axis]);
  const most = Math.max(...extent);
  const from = [0.55, -1, 0.5].map((base, axis) => base / (0.3 + extent[axis] / most));
  const away = new THREE.Vector3(...from).normalize().multiplyScalar(distance);
  kControls.target.set(0, 0, 0);
  kCamera.position.copy(away);
  kControls.update();
  drawSoon();
}

function startView() {
  kRenderer.setClearColor(kBackground);
  kCamera.up.set(0, 0, 1);
  document.body.prepend(kCanvas);
  kControls.screenSpacePanning = true;
  kControls.minDistance = 0.01;
  kControls.maxDistance = 150;
  kControls.addEventListener("change", drawSoon);
  window.addEventListener("resize", fitWindow);
  fitWindow();
  resetView();
}
