"""What the tactile array on a fingertip would see: the contacts of a bent finger's last phalanx, spread over its skin.

    python3 tactile_image.py tactile_image.png
"""
import sys

import matplotlib.pyplot as plt
import numpy as np

import lumbrical as lum

scene = lum.Scene("right")
scene.fade_time = 0
scene.add_object("ball", *lum.make_sphere(0.04, 96))
session = lum.Session(lum.Model(scene))
fingers = 0.13 * (np.arange(20) % 4 != 0)
session.tick(lum.angle_frames(fingers, (0, -0.12, 0.05), (np.sqrt(0.5), np.sqrt(0.5), 0, 0)))

contacts = session.contacts()
pressed = np.bincount(contacts["segment"], weights=np.linalg.norm(contacts["force"], axis=1), minlength=16)
segment = int(pressed.argmax())
contacts = contacts[contacts["segment"] == segment]

# Into the frame of the joint at the segment's base: -z along the bone, x across it.
base = lum.joint_names.index(lum.segment_names[segment])
pose = session.joints[base]
w, v = pose["orientation"][0], pose["orientation"][1:]
arm = contacts["centroid"] - pose["position"]
turned = arm + 2 * np.cross(-v, np.cross(-v, arm) + w * arm)

figure, axes = plt.subplots(figsize=(5, 6))
pressure = np.linalg.norm(contacts["force"], axis=1)
image = axes.hexbin(1e3 * turned[:, 0], -1e3 * turned[:, 2], C=pressure, reduce_C_function=np.sum, gridsize=(12, 18))
figure.colorbar(image, label="force [N]")
axes.set_xlabel("across the finger [mm]")
axes.set_ylabel("towards the tip [mm]")
axes.set_title(f"{lum.segment_names[segment]}: {pressure.sum():.2f} N on {1e6 * contacts['area'].sum():.0f} mm²")
axes.set_aspect("equal")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "tactile_image.png", dpi=120)
