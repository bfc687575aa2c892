// SPDX-License-Identifier: Apache-2.0
// The keys: one table for what they do and for the sheet that lists them.

export interface Binding {
  keys: string[];          // as in `keyOf`
  action: string;
  text: string;            // for the sheet
  group: string;
}

export const bindings: Binding[] = [
  { group: "Play", keys: ["Space"], action: "play", text: "Play or pause" },
  { group: "Play", keys: [",", "."], action: "nudge", text: "Back, on by a tenth of a second" },
  { group: "Play", keys: ["Home", "End"], action: "ends", text: "To the start, to the end" },
  { group: "Play", keys: ["1", "2", "3"], action: "speed", text: "Half, real, double speed" },
  { group: "Keyframes", keys: ["[", "]"], action: "choose",
    text: "Select the keyframe or gate before, after; of an exploration: the image, of a scan: the view" },
  { group: "Keyframes", keys: ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"], action: "move",
    text: "Move what is selected west, east, north, south (Shift: small steps)" },
  { group: "Keyframes", keys: ["PageUp", "PageDown"], action: "lift",
    text: "Move what is selected up, down" },
  { group: "Keyframes", keys: ["Alt+ArrowLeft", "Alt+ArrowRight"], action: "retime",
    text: "Make the selected keyframe earlier, later; turn the selected gate left, right" },
  { group: "Keyframes", keys: ["Alt+ArrowUp", "Alt+ArrowDown"], action: "order",
    text: "Swap it with the one before, after" },
  { group: "Keyframes", keys: ["Alt+PageUp", "Alt+PageDown"], action: "pace",
    text: "Fly the leg to the selected keyframe faster, slower" },
  { group: "Keyframes", keys: ["I"], action: "insert", text: "Insert a keyframe at the play head; of a race: a gate; of a painting: a stroke" },
  { group: "Keyframes", keys: ["P"], action: "place",
    text: "Place keyframes by clicking, or Enter for the middle of the view" },
  { group: "Keyframes", keys: ["B"], action: "draw", text: "Draw keyframes with the mouse; of a painting: strokes" },
  { group: "Keyframes", keys: ["H"], action: "shot", text: "Choose a shot to add" },
  { group: "Keyframes", keys: ["D"], action: "duplicate", text: "Duplicate the selected keyframe; of a zone: add a corner" },
  { group: "Keyframes", keys: ["Delete", "Backspace"], action: "delete",
    text: "Delete what is selected" },
  { group: "Keyframes", keys: ["L"], action: "look",
    text: "Aim the selected keyframe by clicking, or Enter for the middle of the view" },
  { group: "Keyframes", keys: ["Enter"], action: "type", text: "Type numbers for what is selected; of a scan without a selection: click on the middle of the view" },
  { group: "Keyframes", keys: ["C"], action: "cut", text: "Cut one second at the play head" },
  { group: "World", keys: ["O"], action: "obstacle", text: "Add an obstacle" },
  { group: "World", keys: ["U"], action: "subject", text: "Add a subject" },
  { group: "World", keys: ["J"], action: "walk",
    text: "Walk the way of the selected subject: hold the mouse, or Enter, arrows, Enter" },
  { group: "World", keys: ["N"], action: "margins", text: "Margin around obstacles on, off" },
  { group: "View", keys: ["V"], action: "fly-camera",
    text: "Fly the virtual camera (W A S D, Q E, mouse or arrows)" },
  { group: "View", keys: ["K"], action: "keyframe-here", text: "Keyframe of what you see" },
  { group: "View", keys: ["Z"], action: "frame", text: "Show everything" },
  { group: "View", keys: ["E"], action: "map", text: "The world from straight above, as a map; back" },
  { group: "View", keys: ["S"], action: "speeds", text: "The path in the colours of its speed on, off" },
  { group: "View", keys: ["G"], action: "guides", text: "Guides in the picture on, off" },
  { group: "View", keys: ["M"], action: "framing",
    text: "Place the subject in the picture by clicking there" },
  { group: "View", keys: ["T"], action: "theme", text: "Light or dark" },
  { group: "Film", keys: ["F"], action: "fly", text: "Fly it with wind" },
  { group: "Film", keys: ["Q"], action: "race",
    text: "Race it: fly the course by hand (arrows or a gamepad; Space pauses, Escape gives up)" },
  { group: "Film", keys: ["Y"], action: "compare", text: "Keep this version and compare with it" },
  { group: "Film", keys: ["X"], action: "export", text: "Export" },
  { group: "Film", keys: ["R"], action: "report", text: "Write the report" },
  { group: "Film", keys: ["Ctrl+Z"], action: "undo", text: "Undo" },
  { group: "Film", keys: ["Ctrl+Shift+Z", "Ctrl+Y"], action: "redo", text: "Redo" },
  { group: "Film", keys: ["Escape"], action: "escape", text: "Stop, drop the drag, close" },
  { group: "Film", keys: ["?"], action: "help", text: "This sheet" },
];

export interface Pressed {
  key: string;
  ctrlKey: boolean;
  metaKey: boolean;
  altKey: boolean;
  shiftKey: boolean;
}

// "Ctrl+Shift+Z", "I", "?", "ArrowLeft". Shift counts with Ctrl alone: elsewhere it makes steps
// small or is part of the character.
export function keyOf(event: Pressed): string {
  let key = event.key === " " ? "Space" : event.key;
  if (key.length === 1) key = key.toUpperCase();
  const ctrl = event.ctrlKey || event.metaKey;
  return `${ctrl ? "Ctrl+" : ""}${event.altKey ? "Alt+" : ""}` +
    `${ctrl && event.shiftKey ? "Shift+" : ""}${key}`;
}

export function actionOf(event: Pressed): { action: string; key: string } | null {
  const key = keyOf(event);
  const found = bindings.find((binding) => binding.keys.includes(key));
  return found ? { action: found.action, key } : null;
}

const names: Record<string, string> = {
  ArrowLeft: "\u2190", ArrowRight: "\u2192", ArrowUp: "\u2191", ArrowDown: "\u2193",
  PageUp: "Page up", PageDown: "Page down", Escape: "Esc", ",": ", (comma)", ".": ". (dot)",
};

export function keyText(key: string): string {
  const parts = key.split("+");
  return parts.map((part) => names[part] ?? part).join(" + ");
}
