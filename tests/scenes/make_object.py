"""Objects of a scene: their shapes, how they feel and what moves them."""
import math

from at_random import between, direction, orientation, plus, some, vector
from make_mesh import MESH_FILES, rough_ball, scanned_sheet


def built_in_shape(r):
    """A shape of the scene format; and is it closed?"""
    kind = r.choice(["mug", "mug", "box", "box", "sphere", "plane", "height_field"])
    if kind == "mug":
        shape = {"segments": r.choice([8, 16, 32]), **some(
            r, 0.3, radius=r.uniform(0.02, 0.06), wall=r.uniform(0.001, 0.008), height=r.uniform(0.06, 0.15),
            handle_radius=r.uniform(0.003, 0.006), handle_reach=r.uniform(0.02, 0.05))}
    elif kind == "box":
        shape = {"size": [between(r, 0.0005, 0.3) for _ in range(3)], "cells": r.choice([1, 2, 8, 15])}
    elif kind == "sphere":
        shape = {"radius": between(r, 0.003, 0.1), "cells": r.choice([1, 2, 8, 16])}
    elif kind == "plane":  # its triangles are from a tenth of a millimetre to half a kilometre wide
        cells = r.choice([1, 4, 32, 48])
        shape = {"extent": r.choice([0.3, min(1000, cells * between(r, 1e-4, 500))]), "cells": cells,
                 **some(r, 0.5, irregularity=r.random())}
    else:
        shape = {"cells": r.choice([10, 40, 60]), **some(
            r, 0.6, extent=between(r, 0.05, 2), amplitude=r.uniform(0, 0.02), wavelength=between(r, 0.003, 0.2))}
    return {kind: shape}, kind in ("mug", "box", "sphere")


def mesh_object(r, folder, name):
    """A mesh file that is written to the folder; is it closed, and how many triangles has it?"""
    closed = r.random() < 0.6
    vertices, triangles = rough_ball(r) if closed else scanned_sheet(r)
    kind = r.choice(sorted(MESH_FILES))
    (folder / f"{name}.{kind}").write_bytes(MESH_FILES[kind](vertices, triangles))
    size = between(r, 0.01, 0.3)
    fitting = r.choice([{"fit": {"size": size}}, {"unit": "m", "scale": size / 2}, {"unit": "cm", "scale": 50 * size}])
    thing = {"mesh": f"{name}.{kind}", **fitting, **some(r, 0.3, winding=r.choice(["auto", "as is", "flip"]))}
    return thing, closed, len(triangles)


def write_image(r, path):
    """Grey noise or stripes, as text or as bytes."""
    width, height, white = r.randint(1, 24), r.randint(1, 24), r.choice([1, 255, 65535])
    greys = [r.choice([0, white, r.randint(0, white)]) for _ in range(width * height)]
    if white != 255:
        path.write_text(f"P2\n# made at random\n{width} {height}\n{white}\n" + " ".join(map(str, greys)) + "\n")
    else:
        path.write_bytes(f"P5\n{width} {height}\n{white}\n".encode() + bytes(greys))
    return path.name


def surface_feel(r, folder, name, rubs, triangle_count):
    def image(what, most):
        return {"image": write_image(r, folder / f"{name}_{what}.pgm"), "period": between(r, 0.001, 0.1),
                "black": r.uniform(0, most), "white": r.uniform(0, most)}

    feel = some(r, 0.5, crease_angle=r.uniform(0, math.pi), bumps=image("bumps", 0.001))
    if rubs:
        feel.update(some(r, 0.5, grip=image("grip", 3)))
    if rubs and triangle_count and r.random() < 0.5:
        feel["friction_file"] = f"{name}_friction.txt"
        (folder / feel["friction_file"]).write_text("".join(f"{r.uniform(0, 3):.3f}\n" for _ in range(triangle_count)))
    return feel


def joint(r, moves, position):
    if moves == "ball":
        return some(r, 0.5, pivot=plus(position, vector(r, 0.1)))
    return {"axis": direction(r), **some(
        r, 0.4, pivot=plus(position, vector(r, 0.1)), lower=-r.choice([0, 0.005, 0.5]), upper=r.choice([0, 0.005, 0.5]),
        spring=r.choice([0, 0.5, 50, 1e4]), rest=r.uniform(-0.5, 0.5), dry_friction=between(r, 1e-3, 3),
        detent_force=between(r, 1e-3, 3), detent_pitch=between(r, 1e-3, 0.3))}


def body(r, closed):
    """How heavy it is. Of what is not closed all has to be told, since it has no inside."""
    if closed and r.random() < 0.8:
        weight = r.choice([{"mass": between(r, 0.005, 5)}, {"density": between(r, 50, 8000)}])
        return weight | some(r, 0.2, centre=vector(r, 0.01))
    mass = between(r, 0.01, 5)
    moment = mass * between(r, 1e-5, 1e-3)
    moments = [moment, moment * r.uniform(0.6, 1.4), moment] + vector(r, 0.1 * moment)
    return {"mass": mass, "centre": vector(r, 0.01), "inertia": moments}


def motion_of(r, thing, closed, physics):
    """What moves the object, with what it takes for that."""
    moves = r.choice(["free", "free", "hinge", "slider", "ball", "given", "given"])
    if moves == "given" and (physics or r.random() < 0.2):
        return {"moves": moves, **body(r, closed)} if closed else {"moves": moves}
    if moves == "given":
        times = sorted({round(r.uniform(0, 2), 3) for _ in range(r.randint(1, 5))})
        points = [{"time": t, "position": plus(thing["position"], vector(r, 0.02))} for t in times]
        if r.random() < 0.5:
            points = [point | {"orientation": orientation(r)} for point in points]
        del thing["position"]
        thing.pop("orientation", None)
        return {"moves": moves, "path": points}
    return {"moves": moves, **body(r, closed), **some(r, 0.5, damping=between(r, 1e-4, 10)),
            **({} if moves == "free" else {"joint": joint(r, moves, thing["position"])})}


def make_object(r, folder, name, place, physics):
    if r.random() < 0.35:
        thing, closed, triangle_count = mesh_object(r, folder, name)
    else:
        (thing, closed), triangle_count = built_in_shape(r), 0
    thing["name"] = name
    thing["position"] = plus(place, vector(r, r.choice([0, 0.02, 0.06])))
    thing.update(some(r, 0.5, orientation=orientation(r)))
    if r.random() < 0.5:
        friction = between(r, 0.05, 10)
        thing.update(friction=friction, **some(r, 0.3, kinetic_friction=friction * r.random(),
                                               viscosity=between(r, 0.01, 100), shear_stiffness=between(r, 1, 1e5)))
    if r.random() < 0.2:
        thing["surface"] = surface_feel(r, folder, name, "friction" in thing, triangle_count)
    if r.random() < 0.5:
        thing.update(motion_of(r, thing, closed, physics))
    return thing


def add_latch(r, objects):
    """One of two hinges or sliders holds the other until it has been moved."""
    hung = [thing for thing in objects if thing.get("moves") in ("hinge", "slider")]
    if len(hung) > 1:
        held, handle = r.sample(hung, 2)
        held["joint"]["latch"] = {"object": handle["name"], "opens": between(r, 1e-4, 0.3)}
