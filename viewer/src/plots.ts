// Plots along time: hover shows values, a drag zooms, a click goes there. All share one stretch of time.
import uPlot from "uplot";
import { kContacts, kDeviceState, kDifference, kDuration, kForce, kTorque, type Columns } from "./series";
import { brief, colourOf, kDeviceStates, kSegmentCount, kSegments, jointOf } from "./words";

export interface Plots {
  /** `other`: of the recording it is compared with. */
  setData(columns: Columns, other: Columns | undefined): void;
  setRange(from: number, to: number): void;
  setTime(seconds: number): void;
  setTheme(): void;
  destroy(): void;
}

interface Chart {
  title: string;
  unit: string;
  height: number;
  labels: string[];
  columns(from: Columns): Float32Array[];
  stroke(i: number): string;
  dash(i: number): number[] | undefined;
  limit?: number;
  states?: string[];  // whose numbers its values are
  compares?: boolean;  // columns are the other recording's
}

const kDashes = [undefined, [7, 3], [2, 3]];
const byFinger = {
  stroke: colourOf,
  dash: (i: number) => kDashes[i % 3],
};
const ink = () => getComputedStyle(document.documentElement).getPropertyValue("--ink").trim();
const single = (column: number) => ({
  labels: [""],
  columns: (from: Columns) => [from.values[column]],
  stroke: ink,
  dash: () => undefined,
});

function charts(rate: number): Chart[] {
  const segments = (first: number) => (from: Columns) => from.values.slice(first, first + kSegmentCount);
  return [
    { title: "Difference of force per segment", unit: "N", height: 120, labels: kSegments, columns: segments(kDifference), compares: true, ...byFinger },
    { title: "Force per segment", unit: "N", height: 150, labels: kSegments, columns: segments(kForce), ...byFinger },
    { title: "Torque per joint", unit: "N mm", height: 130, labels: kSegments.map((_, s) => jointOf(s)), columns: segments(kTorque), ...byFinger },
    { title: "Contacts", unit: "", height: 100, ...single(kContacts) },
    { title: "Tick time, dashed: the deadline", unit: "us", height: 110, limit: 1e6 / rate, ...single(kDuration) },
    { title: "Device", unit: "", height: 110, states: kDeviceStates, ...single(kDeviceState) },
  ];
}

/** Whether a recording has a tick, or any of the many that a column's number is of. */
function has({ tick, values }: Columns, wanted: number): boolean {
  const step = tick.length > 1 ? tick[1] - tick[0] : 1;
  return !Number.isNaN(values[kContacts][Math.floor((wanted - tick[0]) / step)] ?? NaN);
}

/** As uPlot draws it: a line goes on over numbers that ticks leave out (undefined), not over ticks that a recording lacks (null). */
function lineOf(column: Float32Array, ticks: Float64Array, recordings: Columns[]): (number | null | undefined)[] {
  const isThere = (i: number) => recordings.every((recording) => has(recording, ticks[i]));
  return Array.from(column, (value, i) => (!Number.isNaN(value) ? value : isThere(i) ? undefined : null));
}

const stepped = uPlot.paths.stepped!({ align: 1 });

/** Of the axis along a chart's values. */
function rangeOf({ states }: Chart, low: number | null, high: number | null): [number, number] {
  if (states) return [-0.2, states.length - 0.8];
  return [Math.min(0, low ?? 0), (high ?? 0) > 0 ? 1.05 * high! : 1];
}
const marksOf = ({ states }: Chart): uPlot.Axis =>
  states ? { splits: () => [...states.keys()], values: () => states } : { values: (_, at) => at.map(brief) };

const kLeft = 52, kLeftOfStates = 92;  // [CSS pixels] for what stands before the plots, as much for all, so that times are in one column

/** Behind the point, of labels that are so far apart. */
const digitsFor = (step: number) => Math.max(0, 1 - Math.floor(Math.log10(step)));

/** The largest first, and only those that are there. */
function valuesText(chart: Chart, values: (number | null)[]): DocumentFragment {
  const told = values.map((value, i) => ({ value: value ?? NaN, i })).filter(({ value }) => !Number.isNaN(value));
  const some = chart.labels.length > 1 ? told.filter(({ value }) => value > 0).sort((a, b) => b.value - a.value).slice(0, 2) : told;
  const fragment = document.createDocumentFragment();
  for (const { value, i } of some) {
    const number = document.createElement("b");
    number.textContent = chart.states ? chart.states[value] ?? "" : `${brief(value)} ${chart.unit}`;
    number.style.color = chart.labels.length > 1 ? chart.stroke(i) : "";
    fragment.append(`${chart.labels[i]} `, number, "  ");
  }
  return fragment;
}

export function makePlots(parent: HTMLElement, rate: number, zoom: (from: number, to: number) => void, seek: (time: number) => void): Plots {
  let now = 0;
  let range: [number, number] = [0, 1];
  let last: [Columns, Columns | undefined] | undefined;
  let left = kLeft;
  const made: { chart: Chart; plot: uPlot; box: HTMLElement; values: HTMLElement }[] = [];

  function drawLines(u: uPlot, chart: Chart) {
    const line = (x0: number, y0: number, x1: number, y1: number, dash: number[]) => {
      u.ctx.save();
      u.ctx.strokeStyle = ink();
      u.ctx.setLineDash(dash);
      u.ctx.beginPath();
      u.ctx.moveTo(x0, y0);
      u.ctx.lineTo(x1, y1);
      u.ctx.stroke();
      u.ctx.restore();
    };
    const { left, top, width, height } = u.bbox;
    const x = u.valToPos(now, "x", true);
    if (x >= left && x <= left + width) line(x, top, x, top + height, []);
    const y = chart.limit === undefined ? -1 : u.valToPos(chart.limit, "y", true);
    if (y >= top && y <= top + height) line(left, y, left + width, y, [6, 4]);
  }

  function make(chart: Chart) {
    const box = document.createElement("div");
    box.className = "plot";
    const heading = document.createElement("h2");
    heading.textContent = chart.title + (chart.unit ? ` [${chart.unit}]` : "");
    const values = document.createElement("div");
    values.className = "values";
    const axis = { stroke: ink, font: "12px system-ui, sans-serif", grid: { stroke: "#8884", width: 1 }, ticks: { show: false } };
    const plot = new uPlot({
      width: 410, height: chart.height,
      legend: { show: false },
      scales: { x: { time: false, range: () => range }, y: { range: (_, low, high) => rangeOf(chart, low, high) } },
      axes: [{ ...axis, size: 24, values: (_, at, _axis, _space, step) => at.map((t) => `${+t.toFixed(digitsFor(step))} s`) }, { ...axis, size: () => left, ...marksOf(chart) }],
      series: [{}, ...chart.labels.map((label, i) => ({ label, stroke: () => chart.stroke(i), dash: chart.dash(i), width: 1.25, points: { show: false }, ...(chart.states && { paths: stepped }) }))],
      cursor: { sync: { key: "time" }, drag: { x: true, y: false, setScale: false }, points: { show: false } },
      hooks: {
        draw: [(u) => drawLines(u, chart)],
        setCursor: [(u) => values.replaceChildren(u.cursor.idx == null ? "" : valuesText(chart, u.data.slice(1).map((column, i) => column[u.cursor.idxs![i + 1] ?? -1] ?? null)))],
        setSelect: [(u) => {
          if (u.select.width < 4) return;
          zoom(u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x"));
          u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        }],
      },
    }, undefined, undefined);
    plot.over.addEventListener("click", (event) => {
      if (isClick(event)) seek(plot.posToVal(event.offsetX, "x"));
    });
    const title = document.createElement("div");
    title.className = chart.labels.length > 1 ? "title of-many" : "title";
    title.append(heading, values);
    box.append(title, plot.root);
    box.addEventListener("pointerdown", (event) => (pressedAt = event.clientX), true);
    parent.append(box);
    made.push({ chart, plot, box, values });
  }
  let pressedAt = 0;
  const isClick = (event: MouseEvent) => Math.abs(event.clientX - pressedAt) < 4;
  charts(rate).forEach(make);
  const resizing = new ResizeObserver(() => {
    const width = Math.max(240, parent.clientWidth);
    for (const { chart, plot } of made) if (plot.width !== width) plot.setSize({ width, height: chart.height });
  });
  resizing.observe(parent);
  const setLeft = (next: number) => {
    if (next === left) return;
    left = next;
    for (const { plot } of made) plot.setSize({ width: plot.width, height: plot.height });  // asks for it again
  };

  return {
    setData(own, other) {
      last = [own, other];
      setLeft(own.values[kDeviceState].some((state) => !Number.isNaN(state)) ? kLeftOfStates : kLeft);
      for (const { chart, plot, box } of made) {
        const from = chart.compares ? other : own;
        const columns = from ? chart.columns(from) : [];
        box.hidden = !columns.some((column) => column.some((value) => !Number.isNaN(value)));
        if (from && !box.hidden) plot.setData([Array.from(from.tick, (tick) => tick / rate), ...columns.map((column) => lineOf(column, from.tick, [from, own]))] as uPlot.AlignedData);
      }
    },
    setRange(from, to) {
      // Never narrower than a tick: on an axis without a width that does not begin at 0, marks never end.
      range = [from, Math.max(to, from + 1 / rate)];
      for (const { plot } of made) plot.setScale("x", { min: range[0], max: range[1] });
    },
    setTime(seconds) {
      now = seconds;
      for (const { plot, box } of made) if (!box.hidden) plot.redraw(false, false);
    },
    setTheme() {
      if (last) this.setData(...last);
    },
    destroy() {
      resizing.disconnect();
      for (const { plot, box } of made) {
        plot.destroy();
        box.remove();
      }
    },
  };
}
