// The page's side of the worker: a promise per request.
import type { Answer, Opened, Request, Shown, Source } from "./worker";
import type { Columns, Mark } from "./series";
import type { Comparison } from "./difference";

declare const kWorkerSource: string;  // put in by build.mjs, as is the engine
declare const kEngineBase64: string;

export interface Client {
  open(place: number, source: Source): Promise<Opened>;
  show(place: number, tick: number): Promise<Shown | undefined>;
  window(place: number, first: number, last: number): Promise<Columns>;
  compare(): Promise<Comparison>;
  touch(hand: Float64Array, joints?: string): Promise<Shown | undefined>;
  newest(): Promise<(Shown | undefined)[]>;
  /** And how many ticks there was no room for in it. */
  save(): Promise<{ file: Blob; leftOut: number }>;
  onScanned: (place: number, columns: Columns, marks: Mark[], share: number) => void;
  onError: (text: string) => void;
}

export async function startClient(): Promise<Client> {
  const worker = new Worker(URL.createObjectURL(new Blob([kWorkerSource], { type: "text/javascript" })));
  const waiting = new Map<number, { resolve: (answer: any) => void; reject: (error: Error) => void }>();
  let next = 0;
  const ask = (request: Request, transfer: Transferable[] = []) =>
    new Promise<any>((resolve, reject) => {
      waiting.set(next, { resolve, reject });
      worker.postMessage({ id: next++, request }, transfer);
    });
  const client: Client = {
    open: async (place, source) => (await ask({ type: "open", place, source })).opened,
    show: async (place, tick) => (await ask({ type: "show", place, tick })).shown,
    window: async (place, first, last) => (await ask({ type: "window", place, first, last })).columns,
    compare: async () => (await ask({ type: "compare" })).comparison,
    touch: async (hand, joints) => (await ask({ type: "touch", hand, joints })).shown,
    newest: async () => (await ask({ type: "newest" })).hands,
    save: () => ask({ type: "save" }),
    onScanned() {},
    onError() {},
  };
  worker.onmessage = ({ data }: MessageEvent<Answer>) => {
    if (data.type === "scanned") return client.onScanned(data.place, data.columns, data.marks, data.share);
    const waiter = waiting.get(data.id);
    waiting.delete(data.id);
    if (data.type !== "error") waiter?.resolve(data);
    else if (waiter) waiter.reject(new Error(data.text));
    else client.onError(data.text);
  };
  worker.onerror = (event) => client.onError(`the viewer's worker failed: ${event.message}`);
  const wasm = Uint8Array.from(atob(kEngineBase64), (letter) => letter.charCodeAt(0)).buffer;
  await ask({ type: "load", wasm }, [wasm]);
  return client;
}
