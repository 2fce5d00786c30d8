// The whole session in one strip: total force, marks one can jump to, the stretch the plots show, and now.
import { kContacts, kForce, type Columns, type Mark, type MarkKind } from "./series";
import { largest } from "./largest";
import { kSegmentCount } from "./words";

export interface Strip {
  first: number;
  last: number;
  now: number;
  from: number;
  to: number;
  columns?: Columns;
  marks: Mark[];
}

// A shape of its own for each kind beside its colour.
export const kMarks: Record<MarkKind, { colour: string; sign: string }> = {
  flag: { colour: "#e69f00", sign: "▲" },
  deadline: { colour: "#cc79a7", sign: "●" },
  fault: { colour: "#d55e00", sign: "✖" },
  gap: { colour: "#56b4e9", sign: "■" },
  divergence: { colour: "#009e73", sign: "◆" },
};

export const xOf = (strip: Strip, tick: number, width: number) => ((tick - strip.first) / Math.max(1, strip.last - strip.first)) * width;

function totals({ tick, values }: Columns): Float64Array {
  return Float64Array.from(tick, (_, i) => {
    if (Number.isNaN(values[kForce][i]) && !Number.isNaN(values[kContacts][i])) return NaN;  // left out
    let sum = 0;
    for (let s = 0; s < kSegmentCount; ++s) sum += values[kForce + s][i] || 0;
    return sum;
  });
}

export function drawTimeline(canvas: HTMLCanvasElement, strip: Strip) {
  const ratio = Math.min(devicePixelRatio, 2);
  const { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const context = canvas.getContext("2d")!;
  const style = getComputedStyle(canvas);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.fillStyle = colour("--back");
  context.fillRect(0, 16, width, height - 16);
  const x = (tick: number) => xOf(strip, tick, width);
  if (strip.columns && strip.columns.tick.length > 0) {
    const total = totals(strip.columns);
    const most = largest(total, 1e-9);
    context.fillStyle = colour("--soft");
    context.beginPath();
    context.moveTo(x(strip.columns.tick[0]), height);
    strip.columns.tick.forEach((tick, i) => Number.isNaN(total[i]) || context.lineTo(x(tick), height - (total[i] / most) * (height - 18)));
    context.lineTo(x(strip.columns.tick.at(-1)!), height);
    context.globalAlpha = 0.5;
    context.fill();
    context.globalAlpha = 1;
  }
  context.fillStyle = colour("--accent");
  if (strip.from > strip.first || strip.to < strip.last) {
    context.globalAlpha = 0.18;
    context.fillRect(x(strip.from), 16, Math.max(2, x(strip.to) - x(strip.from)), height - 16);
    context.globalAlpha = 1;
  }
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "center";
  let before = -Infinity;
  for (const mark of strip.marks) {
    const at = x(mark.tick);
    if (at - before < 3) continue;
    before = at;
    context.fillStyle = kMarks[mark.kind].colour;
    context.fillText(kMarks[mark.kind].sign, Math.min(Math.max(at, 6), width - 6), 12);
    context.fillRect(at - 0.5, 15, 1, height - 15);
  }
  context.fillStyle = colour("--ink");
  context.fillRect(x(strip.now) - 1, 14, 2, height - 14);
}
