// Parts of the viewer without a browser: what would take one gigabytes, servers that misbehave, comparisons by the dozen. Arguments:
// browser.mjs.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { before, test } from "node:test";
import { fileURLToPath } from "node:url";

const [program, packages, , scene, folder] = process.argv.slice(2).map((path) => resolve(path));
const file = (name) => join(folder, `part ${name}`);

/** What the viewer's modules export, as build.mjs finds them. */
async function load(...modules) {
  const esbuild = createRequire(join(packages, "package.json"))("esbuild");
  const { outputFiles } = await esbuild.build({
    stdin: {
      contents: modules.map((name) => `export * from "${name}";`).join("\n"),
      resolveDir: join(dirname(fileURLToPath(import.meta.url)), "../../viewer/src"),
    },
    bundle: true, write: false, format: "esm", nodePaths: [join(packages, "node_modules")],
    plugins: [{
      name: "generated",
      setup: (build) => build.onResolve({ filter: /^\.\.\/generated\// }, ({ path }) => ({ path: join(packages, `${path.slice(3)}.ts`) })),
    }],
  });
  return import(`data:text/javascript,${encodeURIComponent(outputFiles[0].text)}`);
}

const { bytesOfFile, bytesOfUrl, compare, loadEngine, openLive, openRecording, segmentRows, Vector3 } =
  await load("./bytes", "./details", "./difference", "./engine", "./live", "./recording", "three");

const run = (given, name, ...args) => execFileSync(program, ["run", given, "--record", file(name), ...args]);
const recording = (name) => openRecording(bytesOfFile(new Blob([readFileSync(file(name))]), name));

before(() => run(scene, "one.mcap", "--ticks", "2500"));

test("A segment that touches two hundred thousand triangles is told like any other", () => {
  const contact = { segment: 0, area: 1e-6, volume: 1e-9, depth: 2e-3 };
  const frame = {
    forces: [new Vector3(1, 0, 0)], jointTorques: [new Vector3()], flexionTorques: [0],
    contacts: Array.from({ length: 200000 }, (_, i) => ({ ...contact, depth: 1e-8 * i })),
  };
  const rows = new Map(segmentRows(0, { frame, world: { stiffness: 2e7 }, hand: "", noContacts: "" }));
  assert.equal(rows.get("contacted triangles"), "200000");
  assert.equal(rows.get("deepest"), "2.00 mm");
});
