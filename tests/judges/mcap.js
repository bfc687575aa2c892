// SPDX-License-Identifier: Apache-2.0
// node mcap.js FILE PLAN: exit status 1 if @mcap/core refuses the file, if a checksum is wrong, or
// if it does not find the plan's topics, schemas and places in it.
const { readFileSync } = require("fs");
const { crc32 } = require("@foxglove/crc");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");

const SCHEMAS = {
  "/tf": "foxglove.FrameTransform",
  "/commands": "lapwing.Command",
  "/path": "foxglove.PosesInFrame",
  "/camera/calibration": "foxglove.CameraCalibration",
};

async function main() {
  const [file, planFile] = process.argv.slice(2);
  const bytes = new Uint8Array(readFileSync(file));
  const samples = JSON.parse(readFileSync(planFile)).samples;
  // The summary, with its checksum.
  const indexed = await McapIndexedReader.Initialize({
    readable: {
      size: async () => BigInt(bytes.length),
      read: async (offset, size) => bytes.slice(Number(offset), Number(offset + size)),
    },
  });
  // The data, whose checksum stands in the record before the summary.
  const end_of_data = Number(indexed.footer.summaryStart);
  const stated = new DataView(bytes.buffer).getUint32(end_of_data - 4, true);
  if (stated === 0 || crc32(bytes.subarray(0, end_of_data - 13)) !== stated)
    throw new Error("checksum of the data");
  const reader = new McapStreamReader({ validateCrcs: true });
  reader.append(bytes);
  const topics = new Map(), schemas = new Map();
  let messages = 0n, last = null;
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Schema") schemas.set(record.id, record.name);
    if (record.type === "Channel") topics.set(record.id, [record.topic, record.schemaId]);
    if (record.type !== "Message") continue;
    messages += 1n;
    const [topic, schema] = topics.get(record.channelId);
    if (schemas.get(schema) !== SCHEMAS[topic]) throw new Error(`${topic} of ${schemas.get(schema)}`);
    const json = JSON.parse(new TextDecoder().decode(record.data));
    if (topic === "/commands") last = { time: Number(record.logTime) / 1e9, ...json.position };
  }
  if (!reader.done()) throw new Error("the file is cut short");
  if (messages !== indexed.statistics.messageCount) throw new Error("number of messages");
  const end = samples[samples.length - 1];
  const gap = end.time - last.time;
  const miss = Math.hypot(last.x - end.position[0], last.y - end.position[1],
                          last.z - end.position[2]);
  if (!(gap >= -1e-6 && gap < 0.021) || !(miss < 0.5)) throw new Error(`ends ${gap} s, ${miss} m off`);
}

main().catch((error) => {
  console.log(error.message);
  process.exit(1);
});
