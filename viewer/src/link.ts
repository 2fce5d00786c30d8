// What a link to the page holds, behind its #: recordings, tick, camera.

export interface Link {
  recordings: string[];
  live?: string;
  tick?: number;
  camera?: number[];  // position and target [m], about the objects' middle
}

export function readLink(hash: string): Link {
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  const camera = given.get("camera")?.split(",").map(Number);
  const tick = given.get("tick");
  return {
    recordings: given.getAll("recording").slice(0, 2),
    live: given.get("live") ?? undefined,
    tick: tick !== null && Number.isInteger(Number(tick)) ? Number(tick) : undefined,
    camera: camera?.length === 6 && camera.every(Number.isFinite) ? camera : undefined,
  };
}

export function writeLink(link: Link): string {
  const out = new URLSearchParams();
  for (const recording of link.recordings) out.append("recording", recording);
  if (link.live) out.set("live", link.live);
  if (link.tick !== undefined) out.set("tick", String(link.tick));
  if (link.camera) out.set("camera", link.camera.map((value) => value.toFixed(4)).join(","));
  return `#${out}`.replaceAll("%2C", ",").replaceAll("%2F", "/");
}
