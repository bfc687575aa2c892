// SPDX-License-Identifier: Apache-2.0
// This page as the viewer of a report: what a server would say is in the report, and nothing can be
// edited or asked for.
import type { Socket } from "../state/session";

export interface ReportData {
  welcome: string;                          // the message
  blob(name: string): string | null;        // base64
}

// What the report has put at the frame that this page stands in; null where a server serves it.
function found(): ReportData | null {
  try {
    return (window.frameElement as (Element & { lapwing?: ReportData }) | null)?.lapwing ?? null;
  } catch {
    return null;                            // a frame of somebody else's
  }
}

export const inReport = found();
if (inReport) document.documentElement.classList.add("in-report");

// A server that greets, and hears nothing.
export function recorded({ welcome }: ReportData): Socket {
  const socket: Socket = {
    send: (text) => {
      if (text.includes('"hello"')) queueMicrotask(() => socket.onmessage?.({ data: welcome }));
    },
    close: () => undefined, onopen: null, onmessage: null, onclose: null,
  };
  queueMicrotask(() => socket.onopen?.());
  return socket;
}

// The frame is shown in place of the still picture.
export function tellDrawn(): void {
  window.frameElement?.dispatchEvent(new Event("drawn"));
}
