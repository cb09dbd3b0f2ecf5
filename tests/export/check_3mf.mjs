// Reads a 3MF file with lib3mf in strict mode, prints what it found as JSON and lets lib3mf write it again:
// check_3mf.mjs FILE AGAIN. Exit code 77 says that lib3mf isn't there (npm ci in this folder).

import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(import.meta.url);
let factory;
try {
  const found = require("@3mfconsortium/lib3mf");
  factory = found.default ?? found;
} catch (error) {
  console.error(String(error));
  process.exit(77);
}

const M = await factory();
const wrapper = new M.CWrapper();
const model = wrapper.CreateModel();
const reader = model.QueryReader("3mf");
reader.SetStrictModeActive(true);
M.FS.writeFile("/a.3mf", readFileSync(process.argv[2]));
try {
  reader.ReadFromFile("/a.3mf");
} catch (error) {
  console.error("lib3mf refuses the file: " + String(error));
  process.exit(1);
}

// The binding hands out no arrays, so lib3mf writes what it understood.
const writer = model.QueryWriter("3mf");
writer.SetDecimalPrecision(9);
writer.WriteToFile("/b.3mf");
writeFileSync(process.argv[3], M.FS.readFile("/b.3mf"));

const objects = [];
const iterator = model.GetMeshObjects();
while (iterator.MoveNext()) {
  const object = iterator.GetCurrentMeshObject();
  const stack = object.GetSliceStack();
  const slices = [];
  for (let i = 0n; i < stack.GetSliceCount(); ++i) {
    const slice = stack.GetSlice(i);
    slices.push([slice.GetZTop(), Number(slice.GetVertexCount()), Number(slice.GetPolygonCount())]);
  }
  objects.push({
    name: object.GetName(),
    closed: object.IsManifoldAndOriented(),
    valid: object.IsValid(),
    lowres: object.GetSlicesMeshResolution() === M.eSlicesMeshResolution.Lowres,
    bottom: stack.GetBottomZ(),
    slices,
  });
}
console.log(JSON.stringify(objects));
