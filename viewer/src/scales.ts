// What is drawn to scale: forces, torques and pressures, as long or bright as the largest seen so far lets them be.
import { largest } from "./largest";
import { niceAbove } from "./legend";
import { renew, state, view } from "./page";
import { kSegmentCount } from "./words";
import type { Columns } from "./series";

/** Of the palm there is none: its joint, the wrist, carries all. */
export const kArcCount = kSegmentCount - 1;

/** The largest of each of so many columns. */
export function whole(columns: Columns, first: number, count: number): number[] {
  return columns.values.slice(first, first + count).map((column) => largest(column));
}

/** NaN: not known. */
export function notice(what: keyof typeof state.most, values: Iterable<number>) {
  const most = niceAbove(largest(values, state.most[what]));
  if (most === state.most[what]) return;
  state.most[what] = most;
  for (const place of state.sides.keys()) setFrame(place);
}

/** Arrows no longer than 60 mm, arcs no wider than three quarters of a turn. */
export const scales = () => ({ force: 0.06 / state.most.force, torque: (1.5 * Math.PI) / state.most.torque });

export function setFrame(place: number) {
  view.setFrame(place, state.sides[place].frame, scales(), state.most.pressure);
  renew();
}
