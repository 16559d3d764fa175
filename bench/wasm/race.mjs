// Usage: node race.mjs WASM NATIVE BODIES FRAMES; see bench/wasm/run.
import initJolt from 'jolt-physics';
import * as rapier3d from '@dimforge/rapier3d/rapier.js';
import {execFileSync} from 'node:child_process';
import {jolt, rapier, winnowInWasm} from './engines.mjs';

const [wasm, program] = process.argv.slice(2);
const [count, frames] = process.argv.slice(4).map(Number);
const WARM_UP = 10;

const winnow = await winnowInWasm(wasm, count);
const engines = [winnow, await jolt(initJolt, count), rapier(rapier3d, count)];
const taken = new Map(engines.map((engine) => [engine, {move: [], detect: [], touching: 0}]));

// The order of the engines rotates from frame to frame.
for (let frame = 0; frame < WARM_UP + frames; ++frame) {
  winnow.advance();
  for (let k = 0; k < engines.length; ++k) {
    const engine = engines[(frame + k) % engines.length];
    const began = performance.now();
    engine.move(winnow.poses());
    const moved = performance.now();
    engine.detect();
    const detected = performance.now();
    if (frame < WARM_UP) continue;
    taken.get(engine).move.push(moved - began);
    taken.get(engine).detect.push(detected - moved);
  }
}
for (const engine of engines) taken.get(engine).touching = engine.touching();

const [isa, ...lines] = execFileSync(program, [count, WARM_UP + frames], {encoding: 'utf8'}).trim().split('\n');
const native = lines.slice(WARM_UP).map((line) => line.split(' ').map(Number));
taken.set({name: `winnow, native ${isa}`}, {move: native.map(([move]) => move), detect: native.map(([, detect]) => detect),
                                            touching: native.at(-1)[2]});

const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
const rows = [...taken].map(([engine, {move, detect, touching}]) => {
  const frame = move.map((value, i) => value + detect[i]);
  return {name: engine.name, move: median(move), detect: median(detect), frame: median(frame), touching};
});
console.log(`${count} spheres and boxes that all move, ${frames} frames, Node ${process.version}; medians, ms`);
console.log('                        move   detect    frame   x winnow   pairs that touch');
for (const row of rows) {
  const figures = [row.move, row.detect, row.frame].map((value) => value.toFixed(2).padStart(8)).join(' ');
  const ratio = (row.frame / rows[0].frame).toFixed(2).padStart(10);
  console.log(`${row.name.padEnd(20)}${figures} ${ratio} ${String(row.touching).padStart(18)}`);
}
