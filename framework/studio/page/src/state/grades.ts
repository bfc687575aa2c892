// SPDX-License-Identifier: Apache-2.0
// How good the curve on display is. An answer counts for the one state of the document that it was
// made for: a revision, and where a drag is under way, an edit of this tab. Anything else is a
// guess, whatever was certified before.
import type { Answer, Certificate, FleetTour, Plan } from "./types";

export type Grade = "guess" | "step" | "converged" | "certified" | "rejected" | "refused";

// What the document is at: `edit` of the drag under way, or null; `pending` gestures that the
// server has not acknowledged.
export interface Moment {
  revision: number;
  edit: number | null;
  pending: number;
}

export interface Standing {
  grade: Grade;
  plan: Plan | null;          // of the current state only
  certificate: Certificate | null;
  message: string;
  ms: number | null;
  tours: FleetTour[];         // of several batteries; else none
}

const order: Grade[] = ["guess", "step", "converged", "rejected", "refused", "certified"];

export function answersMoment(answer: Answer, moment: Moment, tab: string): boolean {
  if (moment.pending > 0 || answer.revision !== moment.revision) return false;
  if (answer.edit === null || answer.edit === undefined) return moment.edit === null;
  return answer.tab === tab && moment.edit === answer.edit;
}

// A certificate must have come with the answer, and have passed, for the word of the server to
// count.
function trusted(answer: Answer): Grade {
  if (answer.grade === "certified") {
    return answer.certificate?.passed === true ? "certified" : "converged";
  }
  return answer.grade;
}

const NONE: FleetTour[] = [];

// Each tour with its plan.
function whole(answer: Answer): Answer {
  const { tours, plan } = answer;
  return tours ? { ...answer, tours: tours.map((tour) => ({ ...tour, plan: tour.plan ?? plan ?? null })) }
    : answer;
}

// What is shown of one tour: its plan, and the checks of the fleet before its own.
export function standingOf(standing: Standing, tour: number): Standing {
  const one = standing.tours[tour];
  if (!one) return standing;
  const fleet = standing.certificate, own = one.certificate;
  return {
    ...standing, plan: one.plan,
    certificate: fleet && own ? { ...fleet, checks: [...fleet.checks, ...own.checks] } : fleet,
  };
}

export class Grades {
  private now: Moment = { revision: 0, edit: null, pending: 0 };
  private answer: Answer | null = null;
  private shown: Answer | null = null;

  constructor(readonly tab: string) {}

  at(moment: Moment): void {
    this.now = { ...moment };
    if (this.answer && !answersMoment(this.answer, this.now, this.tab)) this.answer = null;
  }

  // Whether the answer is for what is on display. An older or a worse one for the same state, come
  // late, does not replace a better one.
  take(told: Answer): boolean {
    const answer = whole(told);
    if (answer.plan && this.isLater(answer)) this.shown = answer;
    if (!answersMoment(answer, this.now, this.tab)) return false;
    const had = this.answer;
    if (had && order.indexOf(trusted(had)) > order.indexOf(trusted(answer))) return false;
    this.answer = answer.plan || !had?.plan ? answer : { ...answer, plan: had.plan };
    if (answer.plan) this.shown = answer;
    return true;
  }

  standing(): Standing {
    const answer = this.answer;
    if (!answer) {
      return { grade: "guess", plan: null, certificate: null, message: "", ms: null, tours: NONE };
    }
    return {
      grade: trusted(answer),
      plan: answer.plan ?? null,
      certificate: answer.certificate ?? null,
      message: answer.message ?? "",
      ms: answer.ms ?? null,
      tours: answer.tours ?? NONE,
    };
  }

  // The newest plan that came, for whatever state: drawn as what it is, out of date.
  lastPlan(): Plan | null {
    return this.shown?.plan ?? null;
  }

  private isLater(answer: Answer): boolean {
    if (answer.edit !== null && answer.edit !== undefined && answer.tab !== this.tab) return false;
    const had = this.shown;
    if (!had) return true;
    if (answer.revision !== had.revision) return answer.revision > had.revision;
    return (answer.edit ?? Infinity) >= (had.edit ?? Infinity) || answer.edit === null;
  }
}
