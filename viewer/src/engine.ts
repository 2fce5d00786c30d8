// The engine as WebAssembly (viewer/engine/viewer_engine.cpp): messages of a recording go in, what a tick looks like comes out.

export interface Engine {
  /** Why only the hand is placed and contacts are not known; empty: they are. Throws what is wrong with the session. `hand`: of
   *  two, which one's ticks are to come. */
  open(session: Uint8Array, state: Uint8Array, hand?: number): string;
  /** The next message is that of this tick. */
  begin(tick: number, first: boolean): void;
  /** Computes a tick; false where the state after it is not the recorded one. */
  pass(message: Uint8Array): boolean;
  /** Computes a tick and returns a TickView. */
  show(message: Uint8Array): Uint8Array;
  /** Whether the state after the last tick is the recorded one. */
  isRecorded(): boolean;
  /** Which results ticks have here, as a recording's metadata "arithmetic" tells it. */
  arithmetic(): string;
  /** A session of the lab: its message. A motion in its options moves the hand from then on. */
  makeSession(options: LabOptions): Uint8Array;
  /** Of tick messages, in binary. */
  schema(): Uint8Array;
  /** Computes the next tick of the lab's hand, a base pose and angles as lab.ts lists them, or the joints that a headset tells: its
   *  message, a TickView, and how long the tick took, reading joints included. */
  touch(hand: Float64Array, joints?: string): { message: Uint8Array; view: Uint8Array; microseconds: number };
}

export interface NamedFile {
  name: string;
  bytes: Uint8Array;
}

/** What a hand touches in the lab, and how. */
export interface LabOptions {
  object: number;  // in the order of lab_object
  mesh?: NamedFile & { metres: number };
  motion?: NamedFile & { side: number; unit: number };  // 0: which the file tells, 1 right, 2 left; [m] a number, 0: its own
  law: number;
  precision: number;
  stiffness: number;  // [N/m^3]
  rate: number;  // [Hz]
}

/** Of what the engine can't read. */
export class Refusal extends Error {}

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  input(size: number): number;
  answer(): number;
  answer_size(): number;
  open(sessionSize: number, stateSize: number, hand: number): number;
  begin(tick: number, first: number): void;
  pass(size: number): number;
  is_recorded_state(): number;
  show(size: number): number;
  arithmetic(): void;
  read_motion(size: number, side: number, unit: number): number;
  make_session(object: number, size: number, metres: number, law: number, precision: number, stiffness: number, rate: number): number;
  schema(): void;
  touch(size: number): void;
  look(): void;
}

// System calls for files, of which there are none.
const kNoSuchCall = -52;

// TypeScript does not know it yet.
declare global {
  namespace WebAssembly {
    class Exception {}
  }
}

/** What the engine throws where memory ends has no text, and is an Error to older machines only. What it was to read may be good: it is no Refusal. */
const telling = (call: WebAssembly.ExportValue) => typeof call !== "function" ? call : (...given: unknown[]) => {
  try {
    return call(...given);
  } catch (error) {
    const told = error instanceof Error && !(error instanceof WebAssembly.Exception);
    throw told ? error : new Error("not enough memory in this page");
  }
};

export async function loadEngine(wasm: BufferSource): Promise<Engine> {
  const module = await WebAssembly.compile(wasm);
  const imports: WebAssembly.Imports = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module))
    (imports[from] ??= {})[name] = () => kNoSuchCall;
  const instance = await WebAssembly.instantiate(module, imports);
  const exports = Object.fromEntries(Object.entries(instance.exports).map(([name, one]) => [name, telling(one)])) as unknown as Exports;
  exports._initialize();

  const put = (...messages: Uint8Array[]) => {
    let at = exports.input(messages.reduce((sum, message) => sum + message.length, 0));
    for (const message of messages) {
      new Uint8Array(exports.memory.buffer, at, message.length).set(message);
      at += message.length;
    }
  };
  const putFile = (file: NamedFile | undefined) => {
    const name = new TextEncoder().encode(`${file?.name ?? ""}\n`);
    put(name, file?.bytes ?? new Uint8Array());
    return name.length + (file?.bytes.length ?? 0);
  };
  const answer = () => new Uint8Array(exports.memory.buffer, exports.answer(), exports.answer_size()).slice();
  const answerText = () => new TextDecoder().decode(answer());
  const must = (good: number) => {
    if (!good) throw new Refusal(answerText());
  };
  const isRecorded = () => exports.is_recorded_state() !== 0;
  return {
    open(session, state, hand = 0) {
      put(session, state);
      must(exports.open(session.length, state.length, hand));
      return answerText();
    },
    begin: (tick, first) => exports.begin(tick, Number(first)),
    pass(message) {
      put(message);
      must(exports.pass(message.length));
      return isRecorded();
    },
    isRecorded,
    show(message) {
      put(message);
      must(exports.show(message.length));
      return answer();
    },
    arithmetic() {
      exports.arithmetic();
      return answerText();
    },
    makeSession({ object, mesh, motion, law, precision, stiffness, rate }) {
      if (motion) must(exports.read_motion(putFile(motion), motion.side, motion.unit));
      must(exports.make_session(object, putFile(mesh), mesh?.metres ?? 0, law, precision, stiffness, rate));
      return answer();
    },
    schema() {
      exports.schema();
      return answer();
    },
    touch(hand, joints = "") {
      const text = new TextEncoder().encode(joints);
      put(new Uint8Array(hand.buffer, hand.byteOffset, hand.byteLength), text);
      const start = performance.now();
      exports.touch(hand.byteLength + text.length);
      const microseconds = 1e3 * (performance.now() - start);
      const message = answer();
      exports.look();
      return { message, view: answer(), microseconds };
    },
  };
}
