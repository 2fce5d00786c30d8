// The legend: pressures' colours, fingers' colours, the scale of arrows.
import { brief, kFingerColours, kFingers } from "./words";
import type { Scales } from "./hand";

/** The next 1, 2 or 5 times a power of ten. */
export function niceAbove(value: number): number {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= value * 0.9999)!;
}

const polynomial = (c: number[], t: number) => Math.round(255 * Math.min(1, Math.max(0, c.reduceRight((sum, k) => sum * t + k, 0))));

/** That of pressure.ts. */
function colourAt(t: number): string {
  const channels = [[-0.01, 1.55, -1.15, 0.6], [0.13, 0.62, 0.06, 0.1], [0.32, 0.8, -1.25, 0.32]];
  return `rgb(${channels.map((c) => polynomial(c, t)).join(",")})`;
}

export function drawLegend(parent: HTMLElement, top: number, scales: Scales, skins: string) {
  const line = (className: string, ...children: (string | Node)[]) => {
    const div = document.createElement("div");
    div.className = className;
    div.append(...children);
    return div;
  };
  const span = (text: string, colour = "") => {
    const element = document.createElement("span");
    element.textContent = text;
    if (colour) {
      element.className = "dot";
      element.style.background = colour;
    }
    return element;
  };
  const bar = line("bar");
  bar.style.background = `linear-gradient(90deg, ${Array.from({ length: 9 }, (_, i) => colourAt(i / 8)).join(", ")})`;
  const fingers = kFingers.flatMap((finger, i) => [span("", kFingerColours[i]), finger]);
  const torqueOf90 = (Math.PI / 2 / scales.torque) * 1e3;
  parent.replaceChildren(
    line("", "Pressure"), bar, line("ends", span("0"), span(`${brief(top)} Pa`)),
    line("", `Arrows: 10 mm are ${brief(0.01 / scales.force)} N; arcs: a quarter is ${brief(torqueOf90)} N mm`),
    line("", ...fingers),
    ...(skins ? [line("", `Skin: ${skins}`)] : []),
  );
}
