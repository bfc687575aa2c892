// SPDX-License-Identifier: Apache-2.0
// "Race it": who flies, with what, against whom; the game itself, and what it came to.
import { devices, Game, gameKeys, KeyStick, padStick, rival, roomier, strengthFor, type Device, type Entrant, type Stick,
         type Track } from "../state/game";
import type { Raced } from "../state/types";
import { show } from "../state/units";
import type { Studio } from "../studio";
import { byId, el, refill } from "../view/dom";
import { RaceView } from "../view/race_view";
import { dialog, writtenList } from "./dialogs";

// What is asked of who flies by hand.
function playerFields(k: number, title: string): HTMLElement {
  const number = (id: string, range: Record<string, number>, value: string): HTMLElement =>
    el("input", { id: `racer-${id}-${k}`, type: "number", ...range, value });
  return el("fieldset", {}, el("legend", {}, title),
    el("label", {}, "Name ", el("input", { id: `racer-name-${k}`, type: "text", maxLength: 40,
                                            placeholder: `Player ${k}` })),
    el("label", {}, "Flies with ", el("select", { id: `racer-device-${k}` },
      ...devices.map(({ device, text }) => el("option", { value: device }, text)))),
    el("label", { title: "0: the plan flies; 1: the stick alone" }, "Weight of the stick ",
       number("weight", { min: 0, max: 1, step: 0.05 }, "0.5")),
    el("label", {}, "Handicap, s ", number("handicap", { min: -3600, max: 3600, step: 0.5 }, "0")));
}

export class RaceGamePanel {
  private readonly box = dialog("race-dialog");
  private readonly hud = byId("race-hud");
  private readonly held = new Set<string>();
  private keySticks = new Map<Device, KeyStick>();
  private entrants: Entrant[] = [];
  private game: Game | null = null;
  private ghost: Track | null = null;        // of the best in the game before
  private ghostName = "";
  private asked: string | null = null;
  // When a key moved a stick, ms: not told yet; on its way. And until it was seen.
  private pressed: number | null = null;
  private told: number | null = null;
  private readonly seen: number[] = [];

  constructor(private readonly studio: Studio, private readonly view: RaceView) {
    byId("racer-two-label").before(playerFields(1, "First player"));
    byId("racer-two-label").after(playerFields(2, "Second player"));
    byId<HTMLSelectElement>("racer-device-2").value = "letters";
    byId("race-go").addEventListener("click", () => this.start());
    byId("race-widen").addEventListener("click", () => studio.edit(roomier(studio.document)));
    window.addEventListener("keydown", (event) => this.key(event), { capture: true });
    window.addEventListener("keyup", (event) => this.held.delete(event.key.toLowerCase()));
    window.addEventListener("blur", () => {
      this.held.clear();
      this.game?.pause("The page lost the keyboard.");
    });
    document.addEventListener("visibilitychange", () => {
      if (document.hidden) this.game?.pause("The page was hidden.");
    });
    window.addEventListener("gamepaddisconnected", (event) => {
      const lost = this.entrants.find(({ device }) => device === `pad${event.gamepad.index + 1}`);
      if (lost) this.game?.pause(`The gamepad of ${lost.name} is gone: connect it again.`);
    });
    studio.on(["link"], () => {
      if (studio.session.link !== "lost" || !this.game?.under) return;
      if (this.game.phase === "starting") this.failed(this.asked ?? "", "The connection was lost.");
      else this.game.pause("The connection is lost.");
    });
    studio.on(["standing", "document"], () => this.showState());
    studio.session.on((event) => {
      const { message } = event;
      if (event.what === "raced" && message?.type === "raced") this.took(message);
      if (event.what === "note" && (message?.type === "failed" || message?.type === "refused")) {
        this.failed(message.id, message.why);
      }
    });
  }

  // What the page tells of a game under way: for tests, and whoever looks into it.
  get figures(): { phase: string; time: number; seen: number[] } | null {
    return this.game && { phase: this.game.phase, time: this.game.state?.time ?? 0,
                          seen: [...this.seen] };
  }

  open(): void {
    if (!this.studio.course) return;
    if (!this.box.open) this.box.show();
    this.showState();
    byId("race-go").focus();
  }

  private showState(): void {
    const { grade } = this.studio.standing;
    byId<HTMLButtonElement>("race-go").disabled = grade !== "certified" && grade !== "rejected";
    byId("race-warning").hidden = grade === "certified" || grade === "rejected";
    byId("race-room").hidden = !roomier(this.studio.document);
  }

  private entrant(k: 1 | 2): Entrant | null {
    if (k === 2 && !byId<HTMLInputElement>("racer-two").checked) return null;
    const number = (id: string, fallback: number): number => {
      const value = byId<HTMLInputElement>(`${id}-${k}`).valueAsNumber;
      return Number.isFinite(value) ? value : fallback;
    };
    return { name: byId<HTMLInputElement>(`racer-name-${k}`).value.trim() || `Player ${k}`,
             device: byId<HTMLSelectElement>(`racer-device-${k}`).value as Device,
             ...strengthFor(this.studio.plan.columns), weight: number("racer-weight", 0.5), speed: 1, handicap: number("racer-handicap", 0) };
  }

  private start(): void {
    const { studio } = this;
    const said = byId("race-result");
    this.entrants = [this.entrant(1), this.entrant(2)].filter((one) => one !== null);
    if (studio.session.link !== "open") {
      said.textContent = "Not connected: try again in a moment.";
      return;
    }
    const used = this.entrants.map(({ device }) => device);
    if (new Set(used).size < used.length) {
      said.textContent = "Two players cannot fly with the same keys or gamepad.";
      return;
    }
    const pace = byId<HTMLSelectElement>("race-rival").value;
    if (pace) this.entrants.push(rival(Number(pace)));
    this.keySticks = new Map(this.entrants.flatMap(({ device }) =>
      (device === "arrows" || device === "letters" ? [[device, new KeyStick(device)]] : [])));
    this.game = new Game((id, time, sticks) => studio.session.stick(id, time, sticks));
    this.asked = studio.session.ask({
      type: "race", id: "",
      players: this.entrants.map(({ device, ...numbers }) =>
        ({ by_hand: device !== null, ...numbers })),
    });
    this.game.begun(this.asked);
    said.textContent = "";
    studio.play(false);
    studio.select(null);
    this.box.close();
    studio.setMode("race");
    byId("world").focus();
    this.view.begin();
    requestAnimationFrame(this.tick);
  }

  private readonly tick = (now: number): void => {
    const { game } = this;
    if (!game?.under) return;
    const left = game.frame(now, (seconds) => this.sticks(seconds));
    this.showHud(left);
    requestAnimationFrame(this.tick);
  };

  private sticks(seconds: number): Stick[] {
    this.told = this.pressed;
    this.pressed = null;
    const pads = navigator.getGamepads?.() ?? [];
    return this.entrants.filter(({ device }) => device !== null).map(({ device, name }) => {
      const keys = this.keySticks.get(device as Device);
      if (keys) return keys.move(this.held, seconds);
      const pad = pads[device === "pad1" ? 0 : 1];
      if (!pad?.connected) {
        this.game?.pause(`There is no gamepad for ${name}: connect it, and press a button of it.`);
        return [0, 0];
      }
      return padStick(pad.axes);
    });
  }

  private took(message: Raced): void {
    const { game } = this;
    if (!game?.is(message.id)) return;
    const now = performance.now();
    game.took(message, now);
    const ghost = byId<HTMLInputElement>("race-ghost").checked ? this.ghost : null;
    this.view.show(game, ghost, now);
    const { told } = this;
    this.told = null;
    if (told !== null) this.seen.push(performance.now() - told);
    if (game.phase === "over") this.over(message);
  }

  private failed(id: string | undefined, why: string): void {
    if (!this.game?.is(id) || !this.game.under) return;
    this.game.fail(why);
    this.leave();
    byId("race-result").replaceChildren(el("p", { class: "field-error", role: "alert" }, why));
    this.box.show();
  }

  private over(message: Raced): void {
    const best = message.players.filter((player) => player.by_hand)
      .sort((a, b) => Number(a.end !== "finished") - Number(b.end !== "finished") ||
        a.score - b.score)[0];
    const track = best && this.game?.tracks.get(best.name);
    if (best && track) {
      this.ghost = track;
      this.ghostName = best.name;
    }
    this.leave();
    byId("race-result").replaceChildren(
      el("pre", { id: "race-score" }, (message.result ?? "").trim()),
      writtenList(message.files ?? [], undefined));
    byId("race-ghost-name").textContent = this.ghostName ? ` (${this.ghostName})` : "";
    this.box.show();
    byId("race-go").focus();
  }

  private leave(): void {
    this.held.clear();
    this.hud.hidden = true;
    this.view.end();
    if (this.studio.mode === "race") this.studio.setMode("orbit");
  }

  // All keys are the game's while it is flown.
  private key(event: KeyboardEvent): void {
    const { game } = this;
    if (!game?.under || event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.toLowerCase();
    if (key === "escape") {
      game.fail("given up");
      this.leave();
      byId("race-result").textContent = "Given up: nothing was written.";
      this.box.show();
    } else if (key === " " || key === "p") {
      if (game.phase === "paused") game.resume(performance.now());
      else game.pause("Paused.");
    } else if (gameKeys.has(key)) {
      if (!this.held.has(key)) this.pressed ??= performance.now();
      this.held.add(key);
      // Not only with the next frame.
      game.frame(performance.now(), (seconds) => this.sticks(seconds));
    } else {
      return;
    }
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  private showHud(left: number): void {
    const { game, hud } = this;
    const state = game?.state;
    hud.hidden = false;
    if (!game || !state) return;
    const big = game.phase === "paused" ? `${game.why} Space: go on.`
      : left > 0 ? String(Math.ceil(left)) : "";
    refill(hud,
      el("ol", { class: "racers" }, ...state.players.map((player, k) =>
        el("li", {}, el("i", { style: `background:${RaceView.colourOf(k)}` }),
           el("b", {}, player.name), player.end
             ? ` ${player.end}` : ` ${show(player.speed, 1)} m/s, ${show(player.deviation, 1)} m off`,
           el("span", {}, `${show(player.score, 1)} s`)))),
      el("p", { class: "clock" }, `${state.time.toFixed(2)} s`),
      big && el("p", { class: "big", role: "status" }, big));
  }
}
