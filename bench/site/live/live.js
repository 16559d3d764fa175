// The scene on the first page: runs live.cpp in WebAssembly and draws its boxes, pairs and query results.
{
  const canvas = document.querySelector('.live canvas');
  const facts = document.querySelector('.live output');
  const amount = document.querySelector('.live input');
  const pause = document.querySelector('.live button');
  const WIDTH = 160, HEIGHT = 90;  // as in live.cpp
  let engine, count = 0, pointer = null, running = true, last = 0;
  const spent = [], steps = [];

  // The WASI imports of the module: an empty environment, no open folders (8: bad file descriptor), and
  // "not supported" (52) for all other calls.
  const system = memory => new Proxy({
    environ_sizes_get(variables, bytes) {
      const view = new DataView(memory().buffer);
      view.setUint32(variables, 0, true);
      view.setUint32(bytes, 0, true);
      return 0;
    },
    environ_get: () => 0,
    fd_prestat_get: () => 8,
    proc_exit(status) { throw new Error(`winnow ended with ${status}`); },
  }, { get: (known, name) => known[name] ?? (() => 52) });

  async function load() {
    const bytes = Uint8Array.from(atob(WINNOW_WASM), c => c.charCodeAt(0));
    const { instance } = await WebAssembly.instantiate(
      bytes, { wasi_snapshot_preview1: system(() => engine.memory) });
    engine = instance.exports;
    engine._initialize?.();
    start();
  }

  const floats = (at, length) => new Float32Array(engine.memory.buffer, at, length);
  const numbers = (at, length) => new Uint32Array(engine.memory.buffer, at, length);

  function start() {
    count = Number(amount.value);
    engine.live_start(count);
    spent.length = 0;
  }

  function draw(pairs, near, hit) {
    const scale = canvas.width / WIDTH;
    const pen = canvas.getContext('2d');
    const boxes = floats(engine.live_boxes(), 6 * count);
    const touched = new Uint8Array(count);
    for (const id of numbers(engine.live_pairs(), 2 * pairs)) touched[id] = 1;
    for (const id of numbers(engine.live_near_ids(), near)) touched[id] |= 2;
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.fillStyle = '#10141a';
    pen.fillRect(0, 0, WIDTH, HEIGHT);
    const colours = ['#3a4553', '#e07b39', '#2f7fb8', '#f4d35e'];
    for (let kind = 0; kind < 4; ++kind) {
      pen.beginPath();
      for (let i = 0; i < count; ++i) {
        if (touched[i] !== kind) continue;
        const k = 6 * i;
        pen.rect(boxes[k], boxes[k + 1], boxes[k + 3] - boxes[k], boxes[k + 4] - boxes[k + 1]);
      }
      pen.globalAlpha = 0.75;
      pen.fillStyle = colours[kind];
      pen.fill();
      pen.globalAlpha = 1;
      pen.lineWidth = 1 / scale;
      pen.strokeStyle = '#10141a';
      pen.stroke();
    }
    if (!pointer) return;
    const t = Math.min(hit, 1);
    pen.lineWidth = 2 / scale;
    pen.strokeStyle = '#fff';
    pen.beginPath();
    pen.moveTo(WIDTH / 2, HEIGHT / 2);
    pen.lineTo(WIDTH / 2 + t * (pointer.x - WIDTH / 2), HEIGHT / 2 + t * (pointer.y - HEIGHT / 2));
    pen.moveTo(pointer.x + 8, pointer.y);
    pen.arc(pointer.x, pointer.y, 8, 0, 7);
    pen.stroke();
  }

  function frame(now) {
    if (running && engine) {
      const step = Math.min((now - last) / 1000, 0.05);
      const before = performance.now();
      const pairs = engine.live_step(step);
      const near = pointer ? engine.live_near(pointer.x, pointer.y, 8) : 0;
      const hit = pointer ? engine.live_ray(pointer.x, pointer.y) : 2;
      spent.push(performance.now() - before);
      draw(pairs, near, hit);
      showFacts(now, pairs);
    }
    last = now;
    requestAnimationFrame(frame);
  }

  function showFacts(now, pairs) {
    steps.push(now);
    while (steps[0] < now - 1000) steps.shift();
    while (spent.length > 60) spent.shift();
    const mean = spent.reduce((a, b) => a + b, 0) / spent.length;
    canvas.dataset.frames = steps.length;
    if (steps.length % 10) return;
    facts.textContent = `${count.toLocaleString('en')} boxes, ${pairs.toLocaleString('en')} pairs, ` +
      `winnow takes ${mean.toFixed(2)} ms a frame, ${steps.length} frames a second`;
  }

  function fit() {
    canvas.width = Math.round(canvas.clientWidth * Math.min(devicePixelRatio, 2));
    canvas.height = Math.round(canvas.width * HEIGHT / WIDTH);
  }

  canvas.addEventListener('pointermove', event => {
    const scale = WIDTH / canvas.clientWidth;
    pointer = { x: event.offsetX * scale, y: event.offsetY * scale };
  });
  canvas.addEventListener('pointerleave', () => { pointer = null; });
  amount.addEventListener('input', start);
  pause.addEventListener('click', () => {
    running = !running;
    pause.textContent = running ? 'Pause' : 'Go on';
  });
  addEventListener('resize', fit);
  fit();
  load().then(() => {
    requestAnimationFrame(frame);
    if (matchMedia('(prefers-reduced-motion: reduce)').matches) pause.click();
  });
}
