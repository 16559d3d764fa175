// Assembles the page.

try {
  writeCaption();
  addLayers();
  startView();
  writeLegend();
  startPicking();
  startPlayer();
} catch (error) {
  const panel = document.createElement("section");
  panel.className = "panel";
  panel.id = "failure";
  panel.textContent = `This page cannot be drawn: ${error.message || error}`;
  document.body.append(panel);
}
