// SPDX-License-Identifier: Apache-2.0
// The bar above: the film's name, how good the curve on display is, undo, and what one does with a
// finished film.
import type { Grade } from "../state/grades";
import type { PlanningProgress } from "../state/types";
import type { Studio } from "../studio";
import { byId } from "../view/dom";

// Each grade has a sign and a word, beside its colour.
export const gradeLooks: Record<Grade, { sign: string; word: string; text: string }> = {
  guess: { sign: "\u2026", word: "Sketch",
           text: "A line through the keyframes. It knows nothing of the drone yet." },
  step: { sign: "\u25d4", word: "Planning", text: "On the way to a path that the drone can fly." },
  converged: { sign: "\u25d1", word: "Checking",
               text: "The best path; whether the drone can fly it is being checked." },
  certified: { sign: "\u2713", word: "Certified",
               text: "Checked independently: the drone can fly exactly this." },
  rejected: { sign: "\u2717", word: "Not flyable",
              text: "The check failed. The red parts of the path and the list say why." },
  refused: { sign: "!", word: "Not possible", text: "This cannot be planned as it is." },
};

// "Planning: tour, 40 %, about 12 s left"
export function progressText({ phase, fraction, left }: PlanningProgress): string {
  const parts = [phase, fraction === null ? "" : `${Math.floor(100 * fraction)} %`,
                 left === null ? "" : `about ${Math.max(1, Math.round(left))} s left`];
  const known = parts.filter(Boolean).join(", ");
  return known ? `Planning: ${known}` : "Planning\u2026";
}

export class TopBar {
  constructor(private readonly studio: Studio) {
    studio.on(["document", "standing", "link"], () => this.show());
    this.show();
  }

  private show(): void {
    const { studio } = this;
    const { session } = studio;
    byId("mission-name").textContent = session.mission.name || "Connecting\u2026";
    document.title = session.mission.name
      ? `${session.mission.name} \u2013 Lapwing studio` : "Lapwing studio";
    const { grade, message, ms } = studio.standing;
    const look = gradeLooks[grade];
    const badge = byId("grade");
    badge.className = `grade ${grade}`;
    badge.dataset.grade = grade;
    byId("grade-sign").textContent = look.sign;
    byId("grade-word").textContent = look.word;
    const failing = studio.passages.length;
    const more = grade === "rejected" && failing > 0
      ? `${failing} ${failing === 1 ? "place" : "places"} on the path ${
        failing === 1 ? "fails" : "fail"}.` : message || look.text;
    const planning = session.planning();
    byId("grade-text").textContent = !session.welcomed ? "" : planning ? progressText(planning) : more;
    badge.title = ms !== null ? `${look.text} Answered after ${Math.round(ms)} ms.` : look.text;
    const button = (id: string, word: string, key: string, can: boolean, label: string): void => {
      const found = byId<HTMLButtonElement>(id);
      found.disabled = !can;
      found.title = `${word}${label ? `: ${label}` : ""} (${key})`;
    };
    button("undo", "Undo", "Ctrl + Z", session.canUndo || session.pending > 0, session.undoLabel);
    button("redo", "Redo", "Ctrl + Shift + Z", session.canRedo, session.redoLabel);
    const banner = byId("read-only");
    document.body.classList.toggle("read-only", session.welcomed && !session.mission.editable);
    banner.hidden = !session.welcomed || session.mission.editable;
    banner.textContent = session.mission.why_not || "This mission can be looked at, not edited.";
  }
}
