// Assembles the page.

try {
  writeCaption();
  addLayers();
  startView();
  writeLegend();
  startPicking();
  startPlayer();
} catch (error) {
  document.body.append(make("section", {className: "panel", id: "failure",
    textContent: `This page cannot be drawn: ${error.message || error}`}));
}
