// Added to a page of `winnow view` by pages.cmake: writes to #report how many things were sent to the GPU, reads
// back pixels, switches every layer off and on, points at the centre of the frame, and shows all frames.

const kErrors = [...document.querySelectorAll("#failure")].map((panel) => panel.textContent);

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

function switchAndPoint() {
  const pixels = readPixels();
  const boxes = [...document.querySelectorAll("#legend input[type=checkbox]")];
  const shown = boxes.filter((box) => box.checked);
  shown.forEach((box) => box.click());
  const withoutLayers = readPixels().drawn;
  shown.forEach((box) => box.click());
  const middle = new THREE.Vector3(0, 0, 0).project(kCamera);
  choose(objectAt(0.5 * (middle.x + 1) * window.innerWidth,
                  0.5 * (1 - middle.y) * window.innerHeight));
  const pointedAt = document.getElementById("info").textContent;
  choose(-1);
  return {pixels, withoutLayers, pointedAt};
}

function drawnNow() {
  const drawn = {structure: {}};
  for (const layer of kLayers) {
    const into = layer.part ? drawn.structure : drawn;
    const name = layer.part || layer.id;
    into[name] = (into[name] || 0) + drawnBy(layer.counted);
  }
  return drawn;
}

// Counts the frames that draw other numbers of objects, pairs or contacts than their pictures
// state.
function wrongFrames() {
  let wrong = 0;
  kPictures.forEach((picture, index) => {
    showFrame(index);
    const drawn = drawnNow();
    const same = (name) => (drawn[name] || 0) === picture.counts[name];
    wrong += same("objects_drawn") && same("pairs_drawn") && same("contacts") ? 0 : 1;
  });
  showFrame(0);
  return wrong;
}

const kReport = {drawn: drawnNow(), frames: kPictures.length, errors: kErrors,
                 ...switchAndPoint()};
if (kPictures.length > 1) kReport.wrongFrames = wrongFrames();
const kElement = document.createElement("pre");
kElement.id = "report";
kElement.textContent = JSON.stringify(kReport);
document.body.append(kElement);
