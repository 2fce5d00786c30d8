"""Makes scenes at random and runs each in ways that must not change a bit: random_scenes.py PROGRAM [OPTIONS].

A scene is recorded, and run again with every instruction set this machine has, with 1 and 2 threads and every search:
`diff` has to find the recordings the same. Then the first of them is replayed, cut, joined, torn, compressed, changed
and exported. One scene in eight has a mistake and must be refused, in one line that says where it is. Nothing may crash,
hang or be refused for no reason. A scene that fails is kept with its recordings, and the commands that show it are
printed; all others are removed again. The same seed makes the same scene.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True  # it would stay in the source tree

from make_scene import make_mistake, make_scene

SEARCHES = ("tree", "grid", "voxel", "brute")
BRUTE_TRIANGLES = 6000  # with more of them asking for every pair takes too long

# Why a scene may be refused though it has no mistake: only the program can tell, or it was built without something.
FORGIVEN = re.compile(r"can't be made: its handle|can't be aligned|encloses no volume|this build has n|mass is out of range")


class Failure(Exception):
    """What the program should not have done."""


class Refused(Exception):
    """A scene was refused in the words that are for that."""


class Trial:
    """The program in one scene's folder, and what was asked of it."""

    def __init__(self, program, folder, seconds):
        self.program, self.folder, self.seconds, self.commands = program, folder, seconds, []

    def run(self, *words, codes=(0,)):
        """Its standard output. Refused (exit code 2) where that is not one of the codes."""
        self.commands.append([self.program] + [str(word) for word in words])
        try:
            done = subprocess.run(self.commands[-1], cwd=self.folder, capture_output=True, text=True,
                                  timeout=self.seconds, stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            raise Failure(f"no end within {self.seconds:g} s") from None
        if done.returncode < 0:
            raise Failure(f"ended by signal {-done.returncode}: {done.stderr.strip()}")
        if done.returncode not in codes and done.returncode == 2:
            raise Refused(self.refusal(done))
        if done.returncode not in codes:
            raise Failure(f"exit code {done.returncode}: {(done.stderr or done.stdout).strip()}")
        return done.stdout

    def ask(self, *words, codes=(0,)):
        """What it says with --json."""
        text = self.run(*words, "--json", codes=codes)
        try:
            return json.loads(text)
        except ValueError:
            raise Failure(f"no JSON: {text.strip()[:200] or 'nothing'}") from None

    def refusal(self, done):
        """One line that begins with a place: a file with a line in it, a switch, or an object."""
        text = done.stderr.strip()
        if "\n" in text or not re.match(r'(\S+\.\w+|--\w+|object "|hand|the scene|brute force|this build).*\w', text):
            raise Failure(f"refused in words that name no place in one line: {text or 'none'}")
        return text

    def commands_that_show_it(self):
        """The last one, and those before that wrote what it read."""
        shown = self.commands[-1:]
        for command in reversed(self.commands[:-1]):
            written = {name_of(word) for switch, word in zip(command, command[1:]) if switch in ("--record", "-o")}
            if written & {name_of(word) for later in shown for word in later}:
                shown.insert(0, command)
        return [shlex.join(command) for command in shown]


def name_of(word):
    """Without its ending, and a part's number."""
    return word.split(".")[0]


def instruction_sets(program, folder):
    """Those that this machine and build have: the program refuses others."""
    scene = {"objects": [{"box": {}}], "motion": {"grasp": {}}}
    (folder / "any.json").write_text(json.dumps(scene))
    offered = []
    for name in ("scalar", "sse2", "avx2", "avx512", "neon"):
        command = [program, "run", folder / "any.json", "--isa", name, "--ticks", "1"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode == 0:
            offered.append(name)
        elif "not available" not in done.stderr:
            sys.exit(f"{program} does not run: {done.stderr.strip()}")
    (folder / "any.json").unlink()
    return offered


def ways_to_run(r, sets, searches):
    """Every instruction set and every search at least once, with 1 and 2 threads; others are held against the first."""
    sets, searches = r.sample(sets, len(sets)), r.sample(searches, len(searches))
    count = max(len(sets), len(searches))
    ways = [(sets[i % len(sets)], searches[i % len(searches)], 1 + i % 2) for i in range(count)]
    return [["--isa", isa, "--broadphase", search, "--threads", threads] for isa, search, threads in ways]


def side_switch(trial):
    """Where a session has two hands, one of them."""
    return ["--side", trial.r.choice(["left", "right"])] if trial.scene["motion"].get("side") == "both" else []


def check_forces(trial, most):
    """Numbers are finite, and no segment has more than the scene allows."""
    trial.run("export", "a.mcap", "--columns", "force", "-o", "a.csv", *side_switch(trial))
    with open(trial.folder / "a.csv", newline="") as file:
        for row in csv.DictReader(file):
            numbers = {name: float(text) for name, text in row.items() if text and not text.startswith("0x")}
            wrong = [name for name, value in numbers.items() if not math.isfinite(value)]
            segments = [name[:-6] for name in numbers if name.endswith(".force.x [N]") and "wrench" not in name]
            force = {name: math.hypot(*(numbers[f"{name}.{axis} [N]"] for axis in "xyz")) for name in segments}
            wrong += [name for name in segments if force[name] > 1.00001 * most]
            if wrong:
                raise Failure(f"tick {row['tick']}: {', '.join(wrong)} is not finite, or above max_force")


def check_formats(trial):
    for kind in ("npz", "json"):
        trial.run("export", "a.mcap", "--format", kind, "--columns", "all", "-o", f"a.{kind}")
        if not (trial.folder / f"a.{kind}").stat().st_size:
            raise Failure("an empty table")
    if trial.kept:
        trial.run("export", "a.mcap", trial.kept, "-o", "kept.csv")


def check_part(trial):
    first = trial.r.randrange(trial.ticks)
    end = trial.r.randint(first + 1, trial.ticks)
    trial.run("trim", "a.mcap", "--from-tick", first, "--to-tick", end, "-o", "part.mcap")
    trial.run("verify", "part.mcap")
    trial.run("replay", "part.mcap", *trial.ways[-1])


def check_split(trial):
    trial.run("split", "a.mcap", "--ticks", trial.r.randint(max(1, trial.ticks // 5), trial.ticks), "-o", "cut.mcap")
    parts = sorted(path.name for path in trial.folder.glob("cut.*.mcap"))
    trial.run("replay", *parts)
    trial.run("merge", *parts, "-o", "joined.mcap")
    trial.run("diff", "a.mcap", "joined.mcap")
    trial.run("replay", "joined.mcap")


def check_torn(trial):
    """A file that ends early: what is whole of it replays."""
    content = (trial.folder / "a.mcap").read_bytes()
    (trial.folder / "torn.mcap").write_bytes(content[:trial.r.randrange(len(content) // 2, len(content))])
    told = trial.ask("recover", "torn.mcap", "-o", "whole.mcap", codes=(0, 2, 5))
    if told.get("recovered"):
        trial.run("verify", "whole.mcap", codes=(0, 5))
        trial.run("replay", "whole.mcap")
    elif "holds no whole session" not in told.get("error", "holds no whole session"):
        raise Failure(told["error"])


def check_compressed(trial):
    trial.run("compress", "a.mcap", "--with", trial.r.choice(["zstd", "lz4", "none"]), "-o", "small.mcap")
    trial.run("verify", "small.mcap")
    trial.run("diff", "a.mcap", "small.mcap")
    trial.run("replay", "small.mcap")


def check_what_if(trial):
    """A session that is changed is one of its own, which replays like any."""
    change = trial.r.choice([["--stiffness", "3e6"], ["--precision", "1e-3"], ["--law", "column"]])
    if trial.scene["settings"].get("felt_once") == "always" and change[0] != "--precision":
        change = ["--stiffness", "3e6"]
    trial.run("replay", "a.mcap", *change, *side_switch(trial), "--record", "changed.mcap")
    trial.run("replay", "changed.mcap", *trial.ways[-1])


def check_inspect(trial):
    trial.run("inspect", "scene.json")
    trial.ask("info", "a.mcap")


def stands_still(thing):
    return thing.get("moves", "fixed") == "fixed" and "friction" not in thing and not thing.get("surface")


def check_world(trial):
    """What stands still may lie in a world file: that, too, is felt the same on every way."""
    scene = trial.scene
    still = [thing for thing in scene["objects"] if stands_still(thing)]
    moving = [thing for thing in scene["objects"] if not stands_still(thing)]
    if not still or "physics" in scene or "align" in scene["motion"]:
        return
    (trial.folder / "still.json").write_text(json.dumps({"objects": still}))
    widest = max(thing.get("plane", {}).get("extent", 1) for thing in still)
    trial.run("world", "still.json", "-o", "still.world", "--cell-size", 0.1 * max(1, widest))
    rest = {name: scene[name] for name in scene if name not in ("objects", "execution")}
    rest = rest | {"world": "still.world"} | ({"objects": moving} if moving else {})
    (trial.folder / "inside.json").write_text(json.dumps(rest, indent=1))
    trial.run("run", "inside.json", "--record", "w0.mcap", *trial.ways[0][:2], "--broadphase", "grid")
    trial.run("run", "inside.json", "--record", "w1.mcap", *trial.ways[-1][:2], "--broadphase", "auto", "--threads", 2)
    trial.run("diff", "w0.mcap", "w1.mcap")
    trial.run("replay", "w0.mcap")


CHECKS = (check_part, check_split, check_torn, check_compressed, check_what_if, check_formats, check_inspect,
          check_world)


def record(trial, sets):
    """The first way, and whatever else a recording may keep beside its ticks."""
    r = trial.r
    trial.kept = r.choice(["", "", "", "--poses", "--contacts"])
    keeping = {"--poses": ["--record-poses", 50], "--contacts": ["--record-contacts", 50]}.get(trial.kept, [])
    keeping += r.choice([[]] * 4 + [["--record-scene", 30], ["--record-forces", "none"], ["--record-forces", 7]])
    trial.ways = ways_to_run(r, sets, SEARCHES)
    told = trial.ask("run", "scene.json", "--record", "a.mcap", *trial.ways[0], *keeping)
    trial.ticks, trial.touched = told["ticks"], "nothing was touched" not in json.dumps(told["trouble"])
    if told["triangles"] >= BRUTE_TRIANGLES:
        trial.ways = [["tree" if word == "brute" else word for word in way] for way in trial.ways]


def try_scene(trial, sets, brief):
    record(trial, sets)
    for number, way in enumerate(trial.ways[1:] if not brief else [trial.r.choice(trial.ways[1:])]):
        trial.run("run", "scene.json", "--record", f"b{number}.mcap", *way)
        trial.run("diff", "a.mcap", f"b{number}.mcap")
    trial.run("replay", "a.mcap", *trial.r.choice(trial.ways))
    check_forces(trial, trial.scene["settings"].get("max_force", 20))
    for check in trial.r.sample(CHECKS, 2 if brief else len(CHECKS)):
        check(trial)


def try_seed(seed, trial, sets, brief):
    """What it was refused for, where it should be; else nothing."""
    trial.r = r = random.Random(seed)
    trial.scene = make_scene(r, trial.folder)
    place = make_mistake(r, trial.scene) if r.random() < 1 / 8 else ""
    (trial.folder / "scene.json").write_text(json.dumps(trial.scene, indent=1))
    try:
        try_scene(trial, sets, brief)
    except Refused as refused:
        if place and (place not in str(refused) or len(trial.commands) > 1):
            raise Failure(f"refused, but not for {place}: {refused}") from None
        if not place and not FORGIVEN.search(str(refused)):
            raise Failure(f"refused: {refused}") from None
        return str(refused)
    if place:
        raise Failure(f"not refused, though {place} is wrong")
    return ""


def tell(seed, failure, trial):
    again = ["python3", sys.argv[0], trial.program, "--only", str(seed), "--folder", str(trial.folder.parent)]
    print(f"seed {seed}: {failure}\n  all of it again: {shlex.join(again)}")
    print(f"  cd {shlex.quote(str(trial.folder))}", *trial.commands_that_show_it(), sep="\n  ", flush=True)


def summary(trial):
    touched = "" if trial.touched else ", nothing touched"
    return f"{trial.ticks} ticks, the same on every way{touched}"


def seeds_of(options):
    if options.only:
        return options.only
    count = options.scenes or (10 if options.seconds is None else sys.maxsize)
    return range(options.seed, options.seed + count)


def read_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the lumbrical program")
    parser.add_argument("--folder", help="where scenes and recordings are written; a new one unless given")
    parser.add_argument("--scenes", type=int, help="how many; 10 unless --seconds are given")
    parser.add_argument("--seconds", type=float, help="how long scenes are begun")
    parser.add_argument("--seed", type=int, default=1, help="of the first scene; the next has the next number (1)")
    parser.add_argument("--only", type=int, nargs="+", metavar="SEED", help="these scenes and no others")
    parser.add_argument("--brief", action="store_true", help="of each scene one other way to run and two other checks")
    parser.add_argument("--verbose", action="store_true", help="a line for each scene")
    parser.add_argument("--limit", type=float, default=120, help="seconds after which a command hangs (120)")
    return parser.parse_args()


def main():
    options = read_options()
    program = shutil.which(str(pathlib.Path(options.program).resolve()))
    if not program:
        sys.exit(f"{options.program}: there is no such program; build it, or name another")
    folder = pathlib.Path(options.folder or tempfile.mkdtemp(prefix="scenes-")).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    sets = instruction_sets(program, folder)
    begin = time.monotonic()
    ran = refused = failed = commands = 0
    for seed in seeds_of(options):
        if options.seconds is not None and time.monotonic() - begin >= options.seconds:
            break
        own = folder / str(seed)
        shutil.rmtree(own, ignore_errors=True)
        own.mkdir()
        trial = Trial(program, own, options.limit)
        try:
            reason = try_seed(seed, trial, sets, options.brief)
            ran, refused = ran + (not reason), refused + bool(reason)
            shutil.rmtree(own)
            if options.verbose:
                print(f"seed {seed}:", f"refused: {reason}" if reason else summary(trial), flush=True)
        except Failure as failure:
            failed += 1
            tell(seed, failure, trial)
        commands += len(trial.commands)
    if not failed and not options.folder:
        folder.rmdir()
    print(f"{ran} scenes gave the same on every way, {refused} were refused as they should be, {failed} failed; "
          f"{commands} commands in {time.monotonic() - begin:.0f} s with {', '.join(sets)}"
          + (f"; see {folder}" if failed else ""))
    return 1 if failed or not ran + refused else 0


if __name__ == "__main__":
    sys.exit(main())
