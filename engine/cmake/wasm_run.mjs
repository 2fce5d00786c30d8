// Runs a program compiled for WebAssembly under node: node wasm_run.mjs PROGRAM.wasm [ARGUMENT...]
import { readFile } from "node:fs/promises";
import { WASI } from "node:wasi";

const [program, ...args] = process.argv.slice(2);
const wasi = new WASI({ version: "preview1", args: [program, ...args], env: {}, returnOnExit: true });
// What emscripten asks for beyond WASI are system calls for files, of which there are none.
const kNoSuchCall = -52;
const env = new Proxy({}, { get: () => () => kNoSuchCall });
const module = await WebAssembly.compile(await readFile(program));
const imports = { wasi_snapshot_preview1: wasi.wasiImport, env };
process.exitCode = wasi.start(await WebAssembly.instantiate(module, imports));
