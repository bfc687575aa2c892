// SPDX-License-Identifier: Apache-2.0
// What the page says by itself: notes that go away, the state of the connection, a script that
// changed, and the hint of the first use.
import type { Studio } from "../studio";
import { byId, el } from "../view/dom";

const SHOWN = 7000;    // ms

export class Notices {
  private readonly notes = byId("notes");
  private readonly banner = byId("banner");
  private ofError = false;

  constructor(private readonly studio: Studio) {
    studio.on(["link", "document"], () => this.showLink());
    studio.on(["document"], () => {
      if (this.ofError && !studio.session.scriptError) this.script(undefined);
    });
    studio.session.on((event) => {
      if (event.what === "note" && event.text) this.say(event.text, "bad");
      if (event.what === "script") this.script(event.message);
      if (event.what === "worker" && event.message?.type === "worker") {
        const { state, message } = event.message;
        if (state === "crashed") {
          this.say(`The planner crashed and was started again. ${message ?? ""}`, "bad");
        }
      }
    });
    this.showLink();
  }

  say(text: string, kind: "good" | "bad" | "plain" = "plain"): void {
    const old = [...this.notes.children].find((n) => n.firstChild?.textContent === text);
    old?.remove();
    const note = el("div", { class: `note ${kind}` }, el("span", {}, text),
      el("button", { type: "button", "aria-label": "Dismiss", onclick: () => note.remove() },
         "\u2715"));
    this.notes.append(note);
    while (this.notes.childElementCount > 4) this.notes.firstElementChild?.remove();
    window.setTimeout(() => note.remove(), SHOWN);
  }

  private showLink(): void {
    const { session } = this.studio;
    const lost = session.link === "lost";
    document.body.classList.toggle("lost", lost);
    const box = byId("link");
    box.hidden = !lost;
    const waiting = session.pending;
    const kept = waiting > 0 ? `${waiting} ${waiting === 1 ? "edit is" : "edits are"} kept and will ` +
      "be sent." : "Nothing is lost.";
    const what = session.strange
      ? "The studio does not know this page any more. Open the address that it printed."
      : "Connection lost. Trying again\u2026";
    box.textContent = lost ? `${what} ${kept}` : "";
  }

  private script(message: unknown): void {
    const { session } = this.studio;
    if (session.scriptError) {
      const { message: text, line } = session.scriptError;
      this.banner.replaceChildren(el("strong", {}, "The script has an error"),
        el("span", {}, `${line && !text.includes(`:${line}:`) ? `Line ${line}: ` : ""}${text}. The ` +
          "film stays as it was; save the script again to go on."));
      this.banner.hidden = false;
      this.ofError = true;
      return;
    }
    if (this.ofError) this.banner.hidden = true;
    this.ofError = false;
    const told = (message ?? {}) as { conflict?: boolean; message?: string };
    const close = (): void => { this.banner.hidden = true; };
    if (!told?.conflict) {
      close();
      if (told?.message) this.say(told.message);
      return;
    }
    const choose = (take: string, text: string, title: string): HTMLButtonElement =>
      el("button", { type: "button", title, onclick: () => {
        session.ask({ type: "resolve_script", take });
        close();
      } }, text);
    this.banner.replaceChildren(el("strong", {}, "The script changed on disk"),
      el("span", {}, told.message ?? ""),
      choose("mine", "Keep mine", "Keep the film as it is here"),
      choose("theirs", "Take the script\u2019s", "Drop the edits made here"),
      choose("both", "Both", "Take the script and lay the edits made here over it"));
    this.banner.hidden = false;
  }
}

const firstSteps: Record<string, string> = {
  film: "Drag a numbered ball to move the camera\u2019s path. The picture at the right is what it sees.",
  race: "Drag a numbered gate to move it, with Shift up and down. Alt and the arrows turn it.",
};
const OTHER_FIRST_STEP = "Change an option at the left. The mission is planned again.";

const steps: { text: string; done: (studio: Studio) => boolean }[] = [
  { text: "",
    done: (studio) => studio.session.revision > 0 || studio.session.pending > 0 },
  { text: "Wait for the green \u2713 Certified above: then the drone can fly it. If it is red, the list " +
      "at the right says what to change.",
    done: (studio) => studio.standing.grade === "certified" && studio.session.revision > 0 },
  { text: "Press Space, or the play button below, to watch the flight.",
    done: (studio) => studio.playing },
  { text: "Press \u201cFly it\u201d above to see how a simulated drone flies it in wind.",
    done: (studio) => studio.flown !== null },
  { text: "Press \u201cExport\u201d above to take the flight with you.", done: () => false },
];

// One line that goes along with what one does; closed for good by its cross.
export class Hints {
  private at = 0;
  private readonly box = byId("hint");

  constructor(private readonly studio: Studio) {
    byId("hint-close").addEventListener("click", () => {
      this.box.hidden = true;
      remember("lapwing-hints", "off");
    });
    studio.on(["document", "standing", "playing", "flown", "mode"], () => this.show());
    studio.session.on((event) => {
      if (event.what === "wrote") {
        this.at = steps.length;
        this.show();
      }
    });
    this.show();
  }

  private show(): void {
    const text = byId("hint-text");
    const modes: Partial<Record<string, string>> = {
      place: "Click on the ground to place keyframes, or press Enter for the middle of the view. " +
        "Esc ends it.",
      aim: "Click what the camera is to look at, or press Enter for the middle of the view. " +
        "Esc ends it.",
      draw: "Draw the path with the mouse, from where the film ends. Esc ends it.",
      walk: "Hold the mouse on the ground and lead the subject: the film runs meanwhile. Or Enter, the " +
        "arrows (Shift runs), and Enter again. Esc drops it.",
      camera: "You are the camera: W A S D moves, Q E down and up, drag or arrows turn. K makes a " +
        "keyframe of what you see, Esc ends it. A gamepad does the same: sticks, A for a keyframe.",
    };
    const special = modes[this.studio.mode];
    if (special) {
      text.textContent = special;
      this.box.hidden = false;
      return;
    }
    if (this.studio.standing.grade === "rejected" && this.at < 3) {
      text.textContent = "The red parts cannot be flown. Take the advice in the list at the right, " +
        "or undo.";
      this.box.hidden = recall("lapwing-hints") === "off";
      return;
    }
    while (this.at < steps.length && steps[this.at]?.done(this.studio)) this.at += 1;
    const step = steps[this.at];
    this.box.hidden = recall("lapwing-hints") === "off" || !step || !this.studio.editable;
    const first = firstSteps[this.studio.session.mission.kind] ?? OTHER_FIRST_STEP;
    if (step) text.textContent = this.at === 0 ? first : step.text;
  }
}

export function remember(key: string, value: string): void {
  try {
    localStorage.setItem(key, value);
  } catch {
    // A browser that keeps nothing shows the hint again: no harm.
  }
}

export function recall(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}
