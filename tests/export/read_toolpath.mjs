// Reads G-code with gcode-toolpath: layers, tool changes, length of tracks by tool, extents. One JSON object.
// Lines of M204 are left out: to a milling machine their T, the acceleration of travel, is a tool.
import { readFileSync } from "node:fs";
import Toolpath from "gcode-toolpath";

const length = {};
const heights = new Set();
const box = [Infinity, -Infinity, Infinity, -Infinity];
let changes = -1;
let tool = null;
const toolpath = new Toolpath({
  addLine: (modal, from, to) => {
    const way = Math.hypot(to.x - from.x, to.y - from.y);
    if (modal.motion !== "G1" || way === 0) return;
    if (modal.tool !== tool) {
      tool = modal.tool;
      ++changes;
    }
    length[tool] = (length[tool] ?? 0) + way;
    heights.add(to.z.toFixed(4));
    for (const { x, y } of [from, to]) {
      box[0] = Math.min(box[0], x);
      box[1] = Math.max(box[1], x);
      box[2] = Math.min(box[2], y);
      box[3] = Math.max(box[3], y);
    }
  },
});
const text = readFileSync(process.argv[2], "utf8").replaceAll(/^M204 .*$/gm, "");
toolpath.loadFromString(text, (error) => {
  if (error) throw error;
  console.log(JSON.stringify({ layers: heights.size, changes, length, box }));
});
