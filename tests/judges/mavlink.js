// SPDX-License-Identifier: Apache-2.0
// node mavlink.js SAMPLES: node-mavlink reads packets that the program SAMPLES (mavlink_samples)
// writes, and the other way round; every field of every message must agree.
const { execFileSync } = require('child_process');
const { Readable } = require('stream');
const {
  MavLinkPacketSplitter, MavLinkPacketParser, MavLinkProtocolV1, MavLinkProtocolV2,
  minimal, standard, common,
} = require('node-mavlink');

const messages = { ...minimal.REGISTRY, ...standard.REGISTRY, ...common.REGISTRY };
const byName = Object.fromEntries(Object.values(messages).map((m) => [m.MSG_NAME, m]));
const samples = process.argv[2];

function fail(text) {
  console.log(text);
  process.exit(1);
}

// A value of node-mavlink as our JSON has it.
function plain(value) {
  if (typeof value === 'bigint') return Number(value);
  if (Array.isArray(value)) return value.map(plain);
  if (typeof value === 'string') return value.replace(/\0.*$/s, '');
  return value;
}

function empty(field) {
  if (field.type === 'char[]') return '';
  return field.type.endsWith('[]') ? Array(field.length).fill(0) : 0;
}

function compare(name, fields, theirs, version) {
  const type = byName[name];
  for (const field of type.FIELDS) {
    if (version === 1 && field.extension) continue;
    const ours = fields[field.source] ?? empty(field);
    const other = plain(theirs(field));
    if (JSON.stringify(ours) !== JSON.stringify(other))
      fail(`${name}.${field.source}: ${JSON.stringify(ours)} and ${JSON.stringify(other)}`);
  }
  const known = new Set(type.FIELDS.map((field) => field.source));
  for (const field of Object.keys(fields))
    if (!known.has(field)) fail(`${name} has no field ${field}`);
}

// Packets of a stream of bytes, with their checksums checked.
async function packetsOf(bytes) {
  const found = [];
  const stream = Readable.from([bytes])
    .pipe(new MavLinkPacketSplitter({}, { magicNumbers: Object.fromEntries(
      Object.entries(messages).map(([id, m]) => [id, m.MAGIC_NUMBER])) }))
    .pipe(new MavLinkPacketParser());
  for await (const packet of stream) found.push(packet);
  return found;
}

// The type that node-mavlink wants for a number of 64 bits.
function theirValue(field, value) {
  const wide = field.type.includes('int64');
  if (Array.isArray(value)) return wide ? value.map(BigInt) : value;
  return wide ? BigInt(value) : value;
}

async function main() {
  const lines = execFileSync(samples, ['write'], { encoding: 'utf8' }).trim().split('\n')
    .map((line) => line.split('\t'))
    .map(([hex, json]) => ({ bytes: Buffer.from(hex, 'hex'), content: JSON.parse(json) }));
  // Ours, read by them.
  const packets = await packetsOf(Buffer.concat(lines.map((line) => line.bytes)));
  if (packets.length !== lines.length)
    fail(`node-mavlink reads ${packets.length} of ${lines.length} packets`);
  packets.forEach((packet, i) => {
    const { message, fields, system, sequence, version } = lines[i].content;
    const type = messages[packet.header.msgid];
    if (type.MSG_NAME !== message || packet.header.sysid !== system ||
        packet.header.seq !== sequence) fail(`${message}: another header`);
    const data = packet.protocol.data(packet.payload, type);
    compare(message, fields, (field) => data[field.name], version);
  });
  // Theirs, read by us.
  const theirs = lines.map(({ content }) => {
    const type = byName[content.message];
    const data = new type();
    for (const field of type.FIELDS)
      data[field.name] = theirValue(field, content.fields[field.source] ?? empty(field));
    const protocol = content.version === 1 ? new MavLinkProtocolV1(content.system, 1)
      : new MavLinkProtocolV2(content.system, 1);
    return protocol.serialize(data, content.sequence).toString('hex');
  });
  const read = execFileSync(samples, ['read'], { input: theirs.join('\n') + '\n', encoding: 'utf8' })
    .trim().split('\n').map((line) => JSON.parse(line));
  if (read.length !== lines.length) fail(`${read.length} of ${lines.length} packets are read`);
  read.forEach((ours, i) => {
    const { content } = lines[i];
    if (ours.message !== content.message || ours.sequence !== content.sequence)
      fail(`${content.message}: another header`);
    compare(content.message, ours.fields, (field) => content.fields[field.source] ?? empty(field),
      content.version);
  });
  const count = new Set(lines.map((line) => line.content.message)).size;
  console.log(`${count} messages, ${lines.length} packets each way`);
}

main().catch((error) => fail(String(error.stack)));
