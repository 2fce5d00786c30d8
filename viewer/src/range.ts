// The stretch of time that the plots show, and what fills them.
import { client, first, last, rate, redraw, say, state } from "./page";
import type { Columns } from "./series";

const kMostWindow = 6000;  // ticks that plots show one by one

export const showsWindow = () => state.to - state.from <= kMostWindow;
let windowed = 0;

export function setRange(from: number, to: number) {
  state.from = Math.max(first(), Math.floor(from));
  state.to = Math.min(last(), Math.ceil(Math.max(to, from + 10)));
  state.plots?.setRange(state.from / rate(), state.to / rate());
  document.body.dataset.range = `${state.from} ${state.to}`;
  fillPlots();
  redraw();
}

export async function fillPlots() {
  const turn = ++windowed;
  if (state.live) return;
  let columns = state.sides.map((side) => side.whole);
  try {
    if (showsWindow()) columns = await Promise.all(state.sides.map((_, place) => client.window(place, state.from, state.to)));
  } catch (error) {
    return say((error as Error).message, true);
  }
  if (turn === windowed && columns[0]) plotColumns(columns);
}

/** Of two hands that which was picked last; of two recordings both, for their difference. */
function plotColumns(columns: (Columns | undefined)[]) {
  if (state.together) state.plots?.setData(columns[state.plotted] ?? columns[0]!, undefined);
  else state.plots?.setData(columns[0]!, columns[1]);
}
