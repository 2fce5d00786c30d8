// What all parts of the page share: its state, the view, the worker, and how the person is told.
import { startClient } from "./client";
import type { Told } from "./details";
import type { Frame, World } from "./frame";
import type { Lab } from "./lab";
import type { Plots } from "./plots";
import { isOfHand, makeView, type Pick } from "./scene";
import type { Columns, Mark } from "./series";
import type { Opened } from "./worker";

export const element = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
export const canvas = element<HTMLCanvasElement>("canvas");
export const strip = element<HTMLCanvasElement>("timeline");

export interface Side {
  opened: Opened;
  world: World;
  link: string;  // empty: a file from disk
  frame?: Frame;
  missing: boolean;  // in the file, of the tick that is shown
  whole?: Columns;
  marks: Mark[];
  milliseconds: number;
}

export const state = {
  sides: [] as Side[],
  tick: 0,
  wanted: 0,  // what is asked for next, with fractions while playing
  playing: false,
  looping: false,
  speed: 1,
  from: 0,  // ticks that the plots show
  to: 1,
  beside: false,
  plotted: 0,  // of two hands, the one in the plots
  together: false,  // the two sides are two hands of one recording, not two recordings
  live: false,  // ticks come by themselves: from a session that runs, or from the lab
  running: false,  // the session has not ended yet
  lab: undefined as Lab | undefined,
  pick: undefined as Pick | undefined,
  most: { force: 1, torque: 0.1, pressure: 1000 },  // seen so far [N], [N m], [Pa]; what is drawn to scale keeps within it
  compared: "",  // what a comparison of two recordings has found
  plots: undefined as Plots | undefined,
  dirty: true,  // the picture is not that of what is said here
  told: NaN,  // tick that the details are of
  unframed: false,  // the camera goes to the hands with the next tick
};

/** The picture is drawn anew. */
export const redraw = () => { state.dirty = true; };
/** And so is what stands beside it. */
export function renew() {
  state.told = NaN;
  redraw();
}
export const view = makeView(canvas, redraw);
export const client = await startClient();

export const rate = () => state.sides[0]?.opened.rate ?? 1000;
/** Of what is open, of two recordings the one that begins earlier, or ends later. */
const limitOf = (pick: (...ticks: number[]) => number, limit: "first" | "last") => (state.sides.length > 0 ? pick(...state.sides.map(({ opened }) => opened[limit])) : 0);
export const first = () => limitOf(Math.min, "first");
export const last = () => limitOf(Math.max, "last");
export const marks = () => state.sides.flatMap((side) => side.marks).sort((a, b) => a.tick - b.tick);

/** What is picked of a hand is told by its own frame, what is picked of the world by both hands'. */
export function toldOf(pick: Pick): Told[] {
  const hand = (place: number) => (state.together ? `${state.sides[place].opened.sides[place]} ` : "");
  return state.sides.flatMap(({ frame, world, opened: { noContacts } }, place) =>
    frame && (place === pick.place || (state.together && !isOfHand(pick))) ? [{ frame, world, hand: hand(place), noContacts }] : []);
}

export function say(text: string, lasts = false) {
  const message = element("message");
  message.textContent = text;
  message.hidden = text === "";
  if (!lasts && text) setTimeout(() => { if (message.textContent === text) message.hidden = true; }, 6000);
}
client.onError = (text) => say(text, true);
