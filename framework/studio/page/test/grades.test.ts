// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { Grades } from "../src/state/grades";
import type { Answer, AnswerGrade, Plan } from "../src/state/types";

const plan = (duration: number): Plan => ({ duration, columns: { time: [0, duration] } });
function answer(
  revision: number, edit: number | null, grade: AnswerGrade, more: Partial<Answer> = {},
): Answer {
  const passed = { passed: grade === "certified", checks: [] };
  return { type: "answer", revision, edit, tab: edit === null ? null : "me", grade,
           plan: plan(revision), certificate: grade === "certified" ? passed : null, ...more };
}

test("only an answer for the very revision counts", () => {
  const grades = new Grades("me");
  grades.at({ revision: 3, edit: null, pending: 0 });
  assert.equal(grades.take(answer(2, null, "certified")), false);
  assert.equal(grades.standing().grade, "guess");
  assert.equal(grades.take(answer(3, null, "certified")), true);
  assert.equal(grades.standing().grade, "certified");
  grades.at({ revision: 4, edit: null, pending: 0 });
  assert.equal(grades.standing().grade, "guess");
  assert.equal(grades.standing().plan, null);
  assert.equal(grades.lastPlan()?.duration, 3);
});

test("a drag, a gesture under way and another tab's edit are guesses", () => {
  const grades = new Grades("me");
  grades.at({ revision: 3, edit: null, pending: 0 });
  grades.take(answer(3, null, "certified"));
  grades.at({ revision: 3, edit: 7, pending: 0 });
  assert.equal(grades.standing().grade, "guess");
  assert.equal(grades.take(answer(3, 6, "certified")), false);
  assert.equal(grades.take(answer(3, 7, "certified", { tab: "other" })), false);
  assert.equal(grades.take(answer(3, null, "certified")), false);
  assert.equal(grades.take(answer(3, 7, "step")), true);
  assert.equal(grades.standing().grade, "step");
  grades.at({ revision: 3, edit: null, pending: 1 });
  assert.equal(grades.take(answer(3, null, "certified")), false);
  assert.equal(grades.standing().grade, "guess");
});

test("the word certified without a passed certificate is not green", () => {
  const grades = new Grades("me");
  grades.at({ revision: 1, edit: null, pending: 0 });
  grades.take(answer(1, null, "certified", { certificate: null }));
  assert.equal(grades.standing().grade, "converged");
  grades.take(answer(1, null, "certified", { certificate: { passed: false, checks: [] } }));
  assert.equal(grades.standing().grade, "converged");
});

test("a late step does not take a certificate away", () => {
  const grades = new Grades("me");
  grades.at({ revision: 1, edit: null, pending: 0 });
  grades.take(answer(1, null, "certified"));
  assert.equal(grades.take(answer(1, null, "step")), false);
  assert.equal(grades.standing().grade, "certified");
});

test("a verdict without a plan keeps the plan that it judges", () => {
  const grades = new Grades("me");
  grades.at({ revision: 1, edit: null, pending: 0 });
  grades.take(answer(1, null, "converged"));
  grades.take(answer(1, null, "rejected", { plan: null, message: "too fast" }));
  assert.equal(grades.standing().grade, "rejected");
  assert.equal(grades.standing().plan?.duration, 1);
  assert.equal(grades.standing().message, "too fast");
});

// Answers of every kind, delayed and in any order: green only for the state on display.
test("shuffled answers never make a wrong green", () => {
  let seed = 12345;
  const random = (n: number): number => {
    seed = (Math.imul(seed, 1103515245) + 12345) >>> 0;
    return (seed >>> 8) % n;
  };
  const kinds: AnswerGrade[] = ["step", "converged", "certified", "rejected", "refused"];
  let greens = 0;
  for (let round = 0; round < 300; ++round) {
    const grades = new Grades("me");
    let now = { revision: 0, edit: null as number | null, pending: 0 };
    grades.at(now);
    const late: Answer[] = [];
    for (let i = 0; i < 60; ++i) {
      const what = random(4);
      if (what === 0) now = { ...now, revision: now.revision + 1, edit: null };
      if (what === 1) now = { ...now, edit: i };
      if (what === 2) now = { ...now, edit: null, pending: random(2) };
      grades.at(now);
      late.push(answer(now.revision, now.edit, kinds[random(5)] as AnswerGrade));
      const came = late.splice(random(late.length), 1)[0] as Answer;
      grades.take(came);
      if (grades.standing().grade === "certified") {
        greens += 1;
        assert.equal(now.pending, 0);
        assert.ok(grades.standing().certificate?.passed);
      }
      if (came.grade === "certified" && grades.standing().grade === "certified" &&
          grades.standing().plan === came.plan) {
        assert.equal(came.revision, now.revision);
        assert.equal(came.edit, now.edit);
      }
    }
  }
  assert.ok(greens > 100);
});
