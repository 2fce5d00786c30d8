"""Runs an example and looks at the picture it leaves: run_example.py EXAMPLE PICTURE."""
import os
import subprocess
import sys

import matplotlib.image
import numpy as np

example, picture = sys.argv[1:]
if os.path.exists(picture):
    os.remove(picture)
subprocess.run([sys.executable, example, picture], check=True)
image = matplotlib.image.imread(picture)[..., :3]
colours = np.unique((255 * image.reshape(-1, 3)).astype(int), axis=0)
coloured = (colours.max(axis=1) - colours.min(axis=1) > 60).sum()
assert min(image.shape[:2]) > 300 and coloured >= 3, "the picture shows nothing"
