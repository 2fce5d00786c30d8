// Bundles the page into one file that needs nothing else, so that it works from this program, from any web server and from disk:
//   node build.mjs ENGINE.wasm PAGE.html      in a folder with node_modules and generated
// esbuild, because one page needs no more than it does: no configuration, no plug-in, a single binary.
import { createHash } from "node:crypto";
import { readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const [engine, page] = process.argv.slice(2).map((path) => resolve(path));
const sources = join(dirname(fileURLToPath(import.meta.url)), "src");
const folder = process.cwd();
const require = createRequire(join(folder, "package.json"));
const esbuild = require("esbuild");

const shared = {
  bundle: true, minify: true, write: false, target: "es2022", legalComments: "none", logLevel: "warning",
  nodePaths: [join(folder, "node_modules")],
  plugins: [{
    name: "generated",
    setup: (build) => build.onResolve({ filter: /^\.\.\/generated\// }, ({ path }) => ({ path: join(folder, `${path.slice(3)}.ts`) })),
  }],
};
const bundle = async (name, format, define = {}) => {
  const { outputFiles } = await esbuild.build({ ...shared, format, define, entryPoints: [join(sources, name)] });
  return outputFiles[0].text;
};
// Text in a page's own script must not end that script.
const literal = (text) => JSON.stringify(text).replaceAll("</", "<\\/");
const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;

const worker = await bundle("worker.ts", "iife");
const base64 = (await readFile(engine)).toString("base64");
const script = (await bundle("main.ts", "esm", { kWorkerSource: literal(worker), kEngineBase64: literal(base64) })).replaceAll("</script", "<\\/script");
const style = (await readFile(join(folder, "node_modules/uplot/dist/uPlot.min.css"), "utf8")) + (await readFile(join(sources, "style.css"), "utf8"));

// Nothing leaves the page's origin; no code and no style but those in the file.
const policy = [
  "default-src 'none'", `script-src ${hash(script)} 'wasm-unsafe-eval'`, `style-src ${hash(style)}`,
  "worker-src blob:", "connect-src 'self'", "img-src 'self' data:", "base-uri 'none'", "form-action 'none'",
].join("; ");
const html = (await readFile(join(sources, "index.html"), "utf8"))
  .replace("<!--policy-->", () => `<meta http-equiv="Content-Security-Policy" content="${policy}">`)
  .replace("<!--style-->", () => `<style>${style}</style>`)
  .replace("<!--script-->", () => `<script type="module">${script}</script>`);
await writeFile(page, html);
