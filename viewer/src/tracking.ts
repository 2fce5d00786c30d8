// A hand as a headset sees it (WebXR Hand Input): joints as they come, frame by frame, as the text of a WebXR capture, which the
// engine reads as it reads any.

export interface Tracking {
  session: XRSession;
  /** A space of the headset whose origin and axes are the lab's, z up, before the person. */
  space: XRReferenceSpace;
  rate: number;  // [Hz] of pictures
  side(): XRHandedness;
  /** The first frame that showed a hand; "": none has. */
  first(): string;
  /** Of this frame, also where it shows no hand. "": none has yet. */
  joints(frame: XRFrame): string;
  end(): void;
}

const kUsualRate = 60;  // [Hz] where the headset does not tell
const kAhead = 0.45, kBelow = 0.35;  // [m] from the eyes to the lab's origin

type Joints = Record<string, { position: number[]; orientation: number[]; radius?: number }>;

export async function isHandTrackingThere(): Promise<boolean> {
  try {
    return (await navigator.xr?.isSessionSupported("immersive-vr")) ?? false;
  } catch {
    return false;  // forbidden to this page
  }
}

function jointsOf(hand: XRHand, frame: XRFrame, space: XRReferenceSpace): Joints {
  const joints: Joints = {};
  for (const [name, joint] of hand.entries()) {
    const pose = frame.getJointPose!(joint, space);
    if (!pose) continue;
    const { position: p, orientation: q } = pose.transform;
    joints[name] = { position: [p.x, p.y, p.z], orientation: [q.x, q.y, q.z, q.w], radius: pose.radius };
  }
  return joints;
}

/** Asks the browser, which asks the person. `ended` is called when the headset is put away. */
export async function trackHand(ended: () => void): Promise<Tracking> {
  const session = await navigator.xr!.requestSession("immersive-vr", { requiredFeatures: ["hand-tracking"] });
  try {
    const tracking = trackingOf(session, await labSpaceOf(session));
    session.addEventListener("end", ended);
    return tracking;
  } catch (error) {
    void session.end();
    throw error;
  }
}

/** Headsets have y up; z up and the origin where hands are. */
async function labSpaceOf(session: XRSession): Promise<XRReferenceSpace> {
  const half = Math.SQRT1_2;
  const place = new XRRigidTransform({ x: 0, y: -kBelow, z: -kAhead }, { x: -half, y: 0, z: 0, w: half });
  return (await session.requestReferenceSpace("local")).getOffsetReferenceSpace(place);
}

function trackingOf(session: XRSession, space: XRReferenceSpace): Tracking {
  let side: XRHandedness = "none";
  let first = "";
  const see = (frame: XRFrame): Joints | undefined => {
    const hands = [...session.inputSources].filter((source) => source.hand);
    const source = hands.find(({ handedness }) => handedness === (side === "none" ? "right" : side)) ?? (side === "none" ? hands[0] : undefined);
    const joints = source && jointsOf(source.hand!, frame, space);
    if (!joints?.wrist) return undefined;
    side = source!.handedness;
    return joints;
  };
  return {
    session, space,
    rate: session.frameRate ?? kUsualRate,
    side: () => side,
    first: () => first,
    joints(frame) {
      const seen = see(frame);
      const text = JSON.stringify([{ time: 0, joints: seen ?? null }]);
      if (seen) first ||= text;
      return first && text;
    },
    end: () => void session.end(),
  };
}
