// A hand as a headset tells it, for the tests: 25 joints of a stiff right hand, and a WebXR device that a page finds in its browser.

/** Where the wrist is [m] at a time [s], y up: from the front over the lab's origin, down and up again. */
export const wristAt = (time) => [-0.02 + 0.02 * Math.sin(5 * time), -0.22 - 0.06 * Math.sin(3 * time), -0.3];

/** Joints by WebXR's names, fingers ahead and the palm down. */
export function jointsAt(time) {
  const [x, y, z] = wristAt(time);
  const joints = {};
  const put = (name, right, up, back) => {
    joints[name] = { position: [x + right, y + up, z + back], orientation: [0, 0, 0, 1], radius: 0.009 };
  };
  put("wrist", 0, 0, 0);
  for (const [i, name] of ["metacarpal", "phalanx-proximal", "phalanx-distal", "tip"].entries())
    put(`thumb-${name}`, -0.025 - 0.015 * i, -0.01, -0.03 - 0.029 * i);
  for (const [f, finger] of ["index", "middle", "ring", "pinky"].entries())
    for (const [i, name] of ["metacarpal", "phalanx-proximal", "phalanx-intermediate", "phalanx-distal", "tip"].entries())
      put(`${finger}-finger-${name}`, -0.03 + 0.02 * f, 0, [-0.02, -0.09, -0.13, -0.155, -0.18][i]);
  return joints;
}

/** A capture of so many seconds at 30 Hz. */
export const capture = (seconds) =>
  JSON.stringify([...Array(Math.round(30 * seconds)).keys()].map((i) => ({ time: i / 30, joints: jointsAt(i / 30) })));

/** In the page, before its own scripts: a headset of 72 Hz that sees the hand, loses it for the pictures from 40 to 49, and writes
 *  down in `told` where it said the wrist was; `worn`: how many of its sessions have not ended. */
function install() {
  const joint = (name) => ({ name });
  const space = (matrix) => ({ matrix, getOffsetReferenceSpace: ({ matrix: offset }) => space(matrix.multiply(new DOMMatrix(offset))) });
  // Of a rotation about x, which is all that is needed here.
  const turnOf = (m) => [Math.sin(Math.atan2(m.m23, m.m22) / 2), 0, 0, Math.cos(Math.atan2(m.m23, m.m22) / 2)];
  class Session extends EventTarget {
    inputSources = [{ handedness: "right", hand: new Map(Object.keys(jointsAt(0)).map((name) => [name, joint(name)])) }];
    frameRate = 72;
    pictures = 0;
    updateRenderState() {}
    requestReferenceSpace = async () => space(new DOMMatrix());
    requestAnimationFrame = (call) => requestAnimationFrame((time) => call(time, this.frame()));
    cancelAnimationFrame = (id) => cancelAnimationFrame(id);
    constructor() {
      super();
      ++window.worn;
    }
    async end() {
      --window.worn;
      this.dispatchEvent(new Event("end"));
    }
    frame() {
      const picture = this.pictures++;
      const lost = picture >= 40 && picture < 50;
      const joints = jointsAt(picture / 72);
      return {
        getViewerPose: ({ matrix }) => ({ views: [{ transform: { matrix: matrix.inverse().toFloat32Array() }, projectionMatrix }] }),
        getJointPose(joint, { matrix }) {
          if (lost) return null;
          const { position, orientation, radius } = joints[joint.name];
          const inverse = matrix.inverse();
          const [x, y, z] = [new DOMPoint(...position).matrixTransform(inverse)].flatMap(({ x, y, z }) => [x, y, z]);
          const [qx, qy, qz, qw] = turnOf(inverse);
          if (joint.name === "wrist") window.told.push([x, y, z]);
          return { transform: { position: { x, y, z }, orientation: { x: qx, y: qy, z: qz, w: qw } }, radius };
        },
      };
    }
  }
  const projectionMatrix = [1.4, 0, 0, 0, 0, 1.4, 0, 0, 0, 0, -1, -1, 0, 0, -0.02, 0];  // of its one eye
  window.told = [];
  window.worn = 0;
  window.XRWebGLBinding = undefined;
  window.XRWebGLLayer = class { framebuffer = null; framebufferWidth = 640; framebufferHeight = 480; getViewport = () => ({ x: 0, y: 0, width: 640, height: 480 }); };
  WebGL2RenderingContext.prototype.makeXRCompatible = async () => {};
  Object.defineProperty(navigator, "xr", { value: {
    isSessionSupported: async (mode) => mode === "immersive-vr",
    requestSession: async (mode, { requiredFeatures }) => {
      if (!requiredFeatures.includes("hand-tracking")) throw new Error("no hands were asked for");
      return new Session();
    },
    addEventListener() {},
  } });
}

export const headset = `const wristAt = ${wristAt}; ${jointsAt}; (${install})();`;
