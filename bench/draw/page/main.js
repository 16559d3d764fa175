// Puts the page together, and says in #report what was drawn: as counted on the way to the graphics
// card, and, if the address ends in #pixels, as read back from it.

const kErrors = [];
window.addEventListener("error", (e) => kErrors.push(String(e.message)));

function readPixels() {
  draw();
  const gl = kRenderer.getContext();
  const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  const words = new Uint32Array(pixels.buffer);
  const colours = new Map();
  for (const word of words) colours.set(word, (colours.get(word) || 0) + 1);
  const ground = Math.max(...colours.values());
  return {width, height, colours: colours.size, drawn: words.length - ground, error: gl.getError()};
}

function report() {
  const drawn = {structure: {}};
  for (const layer of kLayers) {
    if (layer.id === "labels") continue;
    const into = layer.part ? drawn.structure : drawn;
    const name = layer.part || layer.id;
    into[name] = (into[name] || 0) + drawnBy(layer.counted);
  }
  const result = {drawn, labels: kLabels.length, three: THREE.REVISION, errors: kErrors};
  if (location.hash === "#pixels") result.pixels = readPixels();
  document.getElementById("report").textContent = JSON.stringify(result);
}

function fail(error) {
  kErrors.push(String(error));
  const panel = document.createElement("section");
  panel.className = "panel";
  panel.id = "failure";
  panel.textContent = `This page cannot be drawn: ${error.message || error}`;
  document.body.append(panel);
  document.getElementById("report").textContent = JSON.stringify({errors: kErrors});
}

try {
  writeCaption();
  addLayers();
  startView();
  writeLegend();
  startPicking();
  report();
} catch (error) {
  fail(error);
}
