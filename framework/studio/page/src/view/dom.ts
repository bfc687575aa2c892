// SPDX-License-Identifier: Apache-2.0
// Elements, in few words.

type Child = Node | string | null | undefined | false;
type Props = Record<string, unknown>;

// Properties that an element has are set as such, `on...` are listeners, the rest are attributes.
export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K, props: Props = {}, ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on") && typeof value === "function") {
      element.addEventListener(name.slice(2), value as EventListener);
    } else if (name === "class") {
      element.className = String(value);
    } else if (name in element && !name.includes("-") && name !== "list" && name !== "role") {
      (element as unknown as Props)[name] = value;
    } else {
      element.setAttribute(name, value === true ? "" : String(value));
    }
  }
  for (const child of children) if (child) element.append(child);
  return element;
}

export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`no element ${id}`);
  return found as T;
}

// Replaces the children, keeping the focus on the element of the same key where there is one.
export function refill(parent: HTMLElement, ...children: Child[]): void {
  const active = document.activeElement;
  const key = active instanceof HTMLElement && parent.contains(active)
    ? active.dataset.key : undefined;
  parent.replaceChildren(...children.filter((c): c is Node | string => Boolean(c)));
  if (!key) return;
  const again = parent.querySelector(`[data-key="${CSS.escape(key)}"]`);
  if (again instanceof HTMLElement) again.focus({ preventScroll: true });
}

export function typing(target: EventTarget | null): boolean {
  return (target instanceof HTMLInputElement && target.type !== "range" &&
    target.type !== "checkbox" && target.type !== "radio") ||
    target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement;
}

const colours = new Map<string, string>();

// A colour of the style sheet, as the theme has it.
export function colour(name: string): string {
  let found = colours.get(name);
  if (found === undefined) {
    found = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    colours.set(name, found);
  }
  return found;
}

// The theme is another one.
export function forgetColours(): void {
  colours.clear();
}

// A canvas as large as its element, in device pixels; its context draws in CSS pixels.
export function sized(canvas: HTMLCanvasElement): CanvasRenderingContext2D | null {
  const scale = Math.min(window.devicePixelRatio || 1, 2);
  const width = Math.round(canvas.clientWidth * scale);
  const height = Math.round(canvas.clientHeight * scale);
  // Setting the width clears all pixels, and every state that the drawing before has left.
  canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  const context = canvas.getContext("2d");
  context?.setTransform(scale, 0, 0, scale, 0, 0);
  return context;
}

// Calls `move` while a pointer is held on an element, then `end` once: true where it was let go,
// false for Escape and for a pointer that is taken away.
export function whileHeld(
  element: HTMLElement, pointer: number, move: (event: PointerEvent) => void,
  end: (kept: boolean) => void,
): void {
  element.setPointerCapture(pointer);
  const finish = (kept: boolean): void => {
    element.removeEventListener("pointermove", move);
    element.removeEventListener("pointerup", up);
    element.removeEventListener("pointercancel", cancel);
    window.removeEventListener("keydown", escape, true);
    end(kept);
  };
  const up = (): void => finish(true);
  const cancel = (): void => finish(false);
  const escape = (event: KeyboardEvent): void => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    finish(false);
  };
  element.addEventListener("pointermove", move);
  element.addEventListener("pointerup", up);
  element.addEventListener("pointercancel", cancel);
  window.addEventListener("keydown", escape, true);
}
