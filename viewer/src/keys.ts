// Keys, and the help that lists them.

export interface Command {
  keys: string[];  // as KeyboardEvent.key has them
  text: string;
  run: (event: KeyboardEvent) => void;
}

const kShown: Record<string, string> = { " ": "space", ArrowLeft: "←", ArrowRight: "→", Escape: "Esc" };

export function listenToKeys(commands: Command[]) {
  addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || target.matches("select, input:not([type=file]), dialog *")) return;
    if (event.key === " " && target.matches("button")) return;  // it is pressed by that
    const command = commands.find(({ keys }) => keys.includes(event.key) || keys.includes(event.key.toLowerCase()));
    if (!command) return;
    event.preventDefault();
    command.run(event);
  });
}

export function fillHelp(dialog: HTMLDialogElement, commands: Command[]) {
  const heading = document.createElement("h1");
  heading.textContent = "Keys and gestures";
  const list = document.createElement("dl");
  const add = (keys: string[], text: string) => {
    const dt = document.createElement("dt");
    const dd = document.createElement("dd");
    for (const key of keys) {
      const kbd = document.createElement("kbd");
      kbd.textContent = kShown[key] ?? (key.length === 1 ? key.toUpperCase() : key);
      dt.append(kbd, " ");
    }
    dd.textContent = text;
    list.append(dt, dd);
  };
  for (const { keys, text } of commands) add(keys, text);
  add(["drag"], "turn the camera; with the right button or two fingers move it; wheel or pinch: nearer, farther");
  add(["click"], "on a segment or triangle: all that is known of it; in a plot: go to that time");
  add(["drag"], "in a plot: see that stretch of time only");
  const close = document.createElement("button");
  close.textContent = "Close";
  close.addEventListener("click", () => dialog.close());
  dialog.replaceChildren(heading, list, close);
}
