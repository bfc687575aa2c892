// SPDX-License-Identifier: Apache-2.0
// Bytes by their checksum: of the server, or of the report that this page stands in.
import { inReport } from "./report";

export async function blob(name: string): Promise<ArrayBuffer> {
  if (inReport) {
    const text = inReport.blob(name);
    if (text === null) throw new Error("the report does not have it");
    return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
  }
  const response = await fetch(name.startsWith("/") ? name : `/blob/${name}`);
  if (!response.ok) throw new Error(`answer ${response.status}`);
  return response.arrayBuffer();
}
