// Plays the frames, with a slider, a button and the arrow keys. Layers that are off and the chosen
// object are kept from frame to frame.

const kFramesPerSecond = 20;
const kPlayer = {at: 0, timer: null};

function showFrame(index) {
  const row = kChosen.place < 0 ? -1 : now.objects.rows[kChosen.place];
  choose(-1);
  removeLayers();
  kPlayer.at = index;
  show(kPictures[index]);
  addLayers();
  writeCaption();
  writeLegend();
  if (row >= 0) choose(now.objects.rows.indexOf(row));
  document.getElementById("at").value = index;
  document.getElementById("which").textContent =
      `frame ${now.counts.frame} of ${kPictures[0].counts.frame} to ` +
      `${kPictures[kPictures.length - 1].counts.frame}`;
  drawSoon();
}

function play(on) {
  clearInterval(kPlayer.timer);
  kPlayer.timer = on ? setInterval(() => showFrame((kPlayer.at + 1) % kPictures.length),
                                   1000 / kFramesPerSecond) : null;
  document.getElementById("play").textContent = on ? "pause" : "play";
}

function startPlayer() {
  if (kPictures.length < 2) return;
  document.getElementById("player").hidden = false;
  const range = document.getElementById("at");
  range.max = kPictures.length - 1;
  const go = (index) => {
    play(false);
    showFrame(Math.min(kPictures.length - 1, Math.max(0, index)));
  };
  range.addEventListener("input", () => go(Number(range.value)));
  document.getElementById("play").addEventListener("click", () => play(kPlayer.timer === null));
  window.addEventListener("keydown", (event) => {
    if (event.target === range) return;
    if (event.key === "ArrowRight") go(kPlayer.at + 1);
    if (event.key === "ArrowLeft") go(kPlayer.at - 1);
  });
  showFrame(0);
}
