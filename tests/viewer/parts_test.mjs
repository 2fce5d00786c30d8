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

const {
  Builder, bytesOfFile, bytesOfUrl, compare, kDeviceState, loadEngine, makePressure, makeReplay, messagesOf, openLive, openRecording, readFrame, readWindow, readWorld,
  scan, segmentRows, Sent, Tick, tickRows, Vector3,
} = await load("./bytes", "./chunk", "./details", "./difference", "./engine", "./frame", "./live", "./pressure", "./recording", "./replay", "./series",
  "../generated/lumbrical/fb/sent", "../generated/lumbrical/fb/tick", "flatbuffers", "three");

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

test("Every triangle that is touched is coloured, however many they are", () => {
  const { mesh, update } = makePressure();
  const count = 50000;
  const world = { positions: Float64Array.from({ length: 9 * count }, (_, i) => i), stiffness: 2e7 };
  const contacts = Array.from({ length: count }, (_, triangle) => ({ segment: 3, object: 0, triangle, area: 1e-6, volume: 1e-9, depth: 2e-3 }));
  for (const shown of [contacts.slice(0, 10), contacts, contacts.slice(0, 10)]) {
    update({ contacts: shown, objects: [], hulls: [] }, world, new Vector3(), 1e5);
    const corners = 3 * shown.length;
    const { attributes: { position, segment }, drawRange } = mesh.geometry;
    assert.equal(drawRange.count, corners);
    assert.deepEqual([position.getZ(corners - 1), segment.getX(corners - 1)], [3 * corners - 1, 3]);
  }
});

/** A message of a running session in the stream. */
function framed(message) {
  const bytes = new Uint8Array(5 + message.length);
  new DataView(bytes.buffer).setUint32(0, message.length, true);
  bytes.set(message, 5);
  return bytes;
}

test("A running session that comes in small pieces is copied once, whatever its length", async (t) => {
  const { session, message } = await recording("one.mcap");
  const first = await message(0);
  const all = Buffer.concat([framed(session), framed(first)]);
  let at = 0;
  t.mock.method(globalThis, "fetch", async () => new Response(new ReadableStream({
    pull(out) {
      if (at < all.length) out.enqueue(new Uint8Array(all.subarray(at, at += 100)));
      else out.close();
    },
  })));
  let copied = 0;
  const bytes = Object.getPrototypeOf(Uint8Array.prototype);
  const { set } = bytes;
  t.mock.method(bytes, "set", function (from, ...rest) {
    copied += from.length;
    return set.call(this, from, ...rest);
  });
  const live = await openLive("live", async () => ({ open: () => "", begin() {}, show() {} }));
  assert.deepEqual(Buffer.from(live.opened.session), Buffer.from(session));
  assert.ok(copied < session.length + 1000, `${copied} bytes for ${session.length}`);
  let shown;
  while (!shown) {
    await new Promise((resolve) => setImmediate(resolve));
    [shown] = live.newest();
  }
  assert.deepEqual(Buffer.from(shown.message), Buffer.from(first));
  assert.throws(() => live.newest(), /the session has ended/);
});

/** What a page says of a server that sends whole files only, and how many bytes it has taken of it. */
async function tooMuch(t, headers) {
  const piece = new Uint8Array(2 ** 24);
  let sent = 0;
  t.mock.method(globalThis, "fetch", async () => new Response(new ReadableStream({
    pull(out) {
      out.enqueue(piece);
      sent += piece.length;
      if (sent > 400e6) out.close();
    },
  }), { headers }));
  await assert.rejects(bytesOfUrl("http://somewhere/whole.mcap"), /whole\.mcap: this server does not send parts of a file, and the whole is too large/);
  return sent;
}

test("A server that tells no length sends no more than a page holds; one that does sends nothing of what is too large", async (t) => {
  assert.ok(await tooMuch(t, {}) < 300e6);
  assert.ok(await tooMuch(t, { "Content-Length": "300000000" }) < 40e6);
});

/** As a page opens it. */
async function engineOf({ session, state }) {
  const engine = await loadEngine(readFileSync(join(packages, "../wasm/viewer/engine/viewer_engine.wasm")));
  engine.open(session, state);
  return engine;
}

test("Where memory ends the engine says so, whatever it was asked for, and goes on", async () => {
  const { message, ...one } = await recording("one.mcap");
  const engine = await engineOf(one);
  engine.begin(0, true);
  for (const length of [2 ** 31 - 1, 2 ** 32 - 1]) assert.throws(() => engine.pass({ length }), { message: "not enough memory in this page" });
  assert.ok(engine.pass(await message(0)));
});

test("Ticks behind the four billionth are known by their numbers", async () => {
  const one = await recording("one.mcap");
  const engine = await engineOf(one);
  engine.begin(2 ** 32, false);
  const first = await one.message(0);
  assert.throws(() => engine.pass(first), /tick 0 came where tick 4294967296 was due/);
});

test("Behind a gap, or a damaged chunk, forces that the file leaves out are not known until they have faded, and no file is blamed", async () => {
  run(scene, "left out.mcap", "--ticks", "3100", "--record-forces", "none");
  const whole = await recording("left out.mcap");
  const missing = { gap: async () => undefined, damaged: async () => { throw new Error("damaged"); } };
  for (const [what, message] of Object.entries(missing)) {
    const show = makeReplay(await engineOf(whole), { ...whole, message: (tick) => (tick >= 2990 && tick < 3000 ? message() : whole.message(tick)) });
    const rowsAt = async (tick) => {
      const { bytes, view, settled } = await show(tick);
      const frame = readFrame({ tick, message: bytes, view, behindGap: !settled });
      return new Map(tickRows(frame, 1, readWorld(whole.session), { noContacts: "", metadata: whole.metadata }, false));
    };
    for (const [tick, isKnown] of [[2989, true], [3000, false], [3001, false], [3060, true], [3000, false]]) {
      const rows = await rowsAt(tick);
      const place = `${what}, tick ${tick}`;
      assert.equal(rows.get("replayed here"), isKnown ? "the same bits" : "not known: behind a gap", place);
      assert.match(rows.get("force of the hand"), isKnown ? /^[1-9]/ : /^not known$/, place);
      assert.match(rows.get("forces"), isKnown ? /computed here/ : /not known: behind a gap/, place);
      assert.match(rows.get("contacts"), /^[1-9]\d* triangles/, place);
    }
  }
});

/** A chunk record that says it has so many bytes of records in so few. */
function chunkRecord(compression, size, compressed) {
  const bytes = new Uint8Array(9 + 32 + compression.length + 8 + compressed);
  const view = new DataView(bytes.buffer);
  view.setUint8(0, 6);
  view.setBigUint64(9 + 16, BigInt(size), true);
  view.setUint32(9 + 28, compression.length, true);
  bytes.set(new TextEncoder().encode(compression), 9 + 32);
  view.setBigUint64(9 + 32 + compression.length, BigInt(compressed), true);
  return bytes;
}

test("The ground is where the session has it", async () => {
  const height = -0.3;
  varied("ground", (given) => { given.ground = { height }; }, 2);
  const { normal, offset } = readWorld((await recording("ground.mcap")).session).ground;
  assert.deepEqual([...normal.toArray(), offset], [0, 0, 1, height]);
});

test("A chunk that would fill the page's memory is refused before it is decompressed", () => {
  for (const compression of ["", "lz4", "zstd"]) {
    assert.throws(() => [...messagesOf(chunkRecord(compression, 2 ** 24 + 1, 2 ** 17))], /declares 16777217 bytes of records; at most 16 MiB/);
    assert.throws(() => [...messagesOf(chunkRecord(compression, 256 * 100 + 1025, 100))], /declares 26625 bytes of records in 100, more than/);
  }
});

test("An index that points to a chunk twice is refused", async () => {
  const bytes = readFileSync(file("one.mcap"));
  const kChunkIndex = 8, kLength = 16;  // bytes of where a chunk is
  const places = [];
  for (let at = 8; at < bytes.length - 8; at += 9 + Number(bytes.readBigUInt64LE(at + 1))) if (bytes[at] === kChunkIndex) places.push(at + 9 + 16);
  bytes.copy(bytes, places[3], places[1], places[1] + kLength);
  bytes.writeUInt32LE(0, bytes.length - 12);  // of the summary no checksum
  await assert.rejects(openRecording(bytesOfFile(new Blob([bytes]), "twice.mcap")), /twice\.mcap: byte \d+: the index points to a chunk twice/);
});

/** A tick's message of which nothing but this is told. */
function tickMessage(tick, { state, flags = 0 }) {
  const builder = new Builder(128);
  let sent = 0;
  if (state !== undefined) {
    Sent.startSent(builder);
    Sent.addState(builder, state);
    sent = Tick.createSentVector(builder, [Sent.endSent(builder)]);
  }
  Tick.startTick(builder);
  Tick.addTick(builder, BigInt(tick));
  Tick.addFlags(builder, flags);
  if (sent) Tick.addSent(builder, sent);
  builder.finish(Tick.endTick(builder));
  return builder.asUint8Array();
}

/** What is read of a whole recording of `count` ticks, those that are missing told by undefined. */
async function scanned(count, tell) {
  const chunk = new Map();
  for (let tick = 0; tick < count; ++tick) if (tell(tick)) chunk.set(tick, tickMessage(tick, tell(tick)));
  const made = { name: "made", rate: 1e-3, first: 0, last: count - 1, chunkCount: 1, chunk: async () => chunk, message: async (tick) => chunk.get(tick) };
  const found = { changes: [] };
  await scan(made, undefined, {
    isThere: () => true, tell: (columns, marks) => Object.assign(found, { columns, marks }), damaged: assert.fail, changed: (change) => found.changes.push(change),
  });
  return { ...found, window: async (first, last) => (await readWindow(made, undefined, first, last, found.changes)).values[kDeviceState] };
}

test("A device's state goes on until the next one is told, its faults and that it has gone are seen and marked", async () => {
  const [disconnected, armed, active, fault] = [0, 2, 3, 4];
  const told = { 0: armed, 5: active, 4001: fault, 4002: active, 6001: disconnected, 6002: active, 9000: armed };
  const { columns, marks, window } = await scanned(12288, (tick) => (tick > 8990 && tick < 8995 ? undefined : { state: told[tick] }));
  const states = columns.values[kDeviceState];
  assert.deepEqual([1, 2, 1300, 1333, 1334, 2000, 2001].map((bucket) => states[bucket]), [armed, active, active, fault, active, disconnected, active]);
  assert.deepEqual(marks.map(({ tick, kind, text }) => [tick, kind, text]),
    [[4001, "fault", "device: fault"], [6001, "fault", "device: disconnected"], [8991, "gap", "4 ticks are missing"]]);
  assert.deepEqual([...await window(5998, 6003)], [active, active, active, disconnected, active, active]);
  assert.deepEqual([...await window(8989, 9001)], [active, active, ...new Array(9).fill(NaN), armed, armed]);
});

test("However many marks of one kind there are, others are marked too, and the last of them says that more follow", async () => {
  const { marks } = await scanned(8000, (tick) => (tick >= 7990 ? undefined : { flags: (tick & 1) | (tick === 7980 ? 8 : 0) }));
  const many = marks.filter(({ text }) => text.startsWith("input not finite"));
  assert.equal(many.length, 3000);
  assert.match(many.at(-1).text, /more of these follow/);
  assert.deepEqual(marks.slice(-2).map(({ tick, text }) => [tick, text]), [[7980, "input extrapolated"], [7990, "10 ticks are missing"]]);
});

/** A variant of the scene, run. */
function varied(name, change, ticks = 2500, ...args) {
  const given = JSON.parse(readFileSync(scene, "utf8"));
  change(given);
  writeFileSync(file(`${name}.json`), JSON.stringify(given));
  run(file(`${name}.json`), `${name}.mcap`, "--ticks", `${ticks}`, ...args);
}

/** As lumbrical diff says it. */
function parting(...names) {
  try {
    return JSON.parse(execFileSync(program, ["diff", "--json", ...names.map(file)])).first_divergence;
  } catch (error) {
    return JSON.parse(error.stdout).first_divergence;
  }
}

test("Recordings part at the tick, stage and field that lumbrical diff names", async () => {
  const softer = ({ settings }) => { settings.stiffness = 1.9e7; };
  varied("softer", softer);
  varied("softer, hashes only", softer, 2500, "--record-forces", "none");
  varied("hashes only", () => {}, 2500, "--record-forces", "none");
  varied("slower", ({ motion }) => { motion.grasp.seconds *= 1.5; });
  varied("coarser", ({ settings }) => { settings.precision = 1e-3; });
  for (const other of ["softer", "softer, hashes only", "hashes only", "slower", "coarser"]) {
    const { divergence } = await compare([await recording("one.mcap")], [await recording(`${other}.mcap`)]);
    const told = parting("one.mcap", `${other}.mcap`);
    const places = (one) => one && [one.tick, one.stage, one.field];
    assert.deepEqual(places(divergence), places(told ?? undefined), other);
    if (other === "softer") assert.deepEqual([divergence.a, divergence.b], [told.recorded, told.replayed]);
  }
});
