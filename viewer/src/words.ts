// Names of hand segments, fingers and flags, in the engine's order and spelling (hand.h, device.h, safety.h).

export const kSegmentCount = 16;
export const kPalm = 15;
export const kFingers = ["thumb", "index", "middle", "ring", "little", "palm"];

const kThumb = ["metacarpal", "proximal", "distal"];
const kOthers = ["proximal", "intermediate", "distal"];
export const kSegments = kFingers
  .slice(0, 5)
  .flatMap((finger, f) => (f === 0 ? kThumb : kOthers).map((bone) => `${finger} ${bone}`))
  .concat("palm");
export const fingerOf = (segment: number) => Math.floor(segment / 3);
/** The joint that moves a segment: the one at its base. */
export const jointOf = (segment: number) => (segment === kPalm ? "wrist" : kSegments[segment]);

// Okabe and Ito's palette, which the colour-blind can tell apart; by finger, palm last.
export const kFingerColours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
export const colourOf = (segment: number) => kFingerColours[fingerOf(segment)];

export const kTickFlags = [
  "input not finite", "input implausible", "input lost", "input extrapolated", "segment missing", "segment degenerate",
  "angle clamped", "candidate overflow", "force limited", "fading", "coarsened", "object missing",
  "object implausible", "memory foreign", "hand jumped",
];
export const kDeviceStates = ["disconnected", "idle", "armed", "active", "fault"];
export const kDisconnected = 0, kFault = 4;

/** Why other bits are no fault, in the words of `lumbrical replay`; empty: it is one, or that is not known. */
export function arithmeticText(recorded: string | undefined, where: string, other: string | undefined): string {
  if (!recorded || !other || recorded === other) return "";
  return `. Recorded by other arithmetic (${recorded}, ${where} ${other}): the same bits are not promised.`;
}

/** 1234.5678 as "1235", 0.00012345 as "0.000123": three digits that matter. */
export function brief(value: number): string {
  if (!Number.isFinite(value)) return "-";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(2);
  return size >= 100 ? value.toFixed(0) : value.toPrecision(3);
}

export function timeText(seconds: number): string {
  const minutes = Math.floor(seconds / 60);
  const rest = (seconds - 60 * minutes).toFixed(3).padStart(6, "0");
  return `${minutes}:${rest}`;
}
