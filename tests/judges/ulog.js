// SPDX-License-Identifier: Apache-2.0
// node ulog.js FILE INFO: exit status 1 if @foxglove/ulog counts other messages in a ULog than
// `lapwing log info FILE --json` wrote to INFO, or if the values of a series differ.
const { readFileSync } = require("fs");
const { ULog } = require("@foxglove/ulog");
const { FileReader } = require("@foxglove/ulog/node.js");

// Of each series: the topic and its fields as the local frame of logs has them (east, north, up;
// forward, left, up).
const NED = (v) => [v[1], v[0], -v[2]];
const FRD = (v) => [v[0], -v[1], -v[2]];
const heading = (h) => Math.atan2(Math.cos(h), Math.sin(h));
const good = (flag) => flag === undefined || flag;
const SERIES = {
  vehicle_local_position: {
    position: (m) => good(m.xy_valid) && good(m.z_valid) && NED([m.x, m.y, m.z]),
    velocity: (m) => good(m.v_xy_valid) && good(m.v_z_valid) && NED([m.vx, m.vy, m.vz]),
    acceleration: (m) => NED([m.ax, m.ay, m.az]),
  },
  vehicle_global_position: { place: (m) => [m.lat, m.lon, m.alt] },
  vehicle_attitude: { orientation: (m) => turned(m.q) },
  vehicle_angular_velocity: { body_rates: (m) => FRD(m.xyz) },
  vehicle_acceleration: { specific_force: (m) => FRD(m.xyz) },
  sensor_combined: { specific_force: (m) => FRD(m.accelerometer_m_s2) },
  vehicle_thrust_setpoint: { throttle: (m) => [-m.xyz[2]] },
  actuator_controls_0: { throttle: (m) => [m.control[3]] },
  actuator_motors: { actuators: (m) => Array.from(m.control).slice(0, 4) },
  battery_status: { battery: (m) => [m.voltage_v, m.current_a, m.remaining] },
  vehicle_rates_setpoint: { rates_setpoint: (m) => FRD([m.roll, m.pitch, m.yaw]) },
  trajectory_setpoint: {
    position_setpoint: (m) => NED(m.position ?? [m.x, m.y, m.z]),
    velocity_setpoint: (m) => NED(m.velocity ?? [m.vx, m.vy, m.vz]),
    yaw_setpoint: (m) => [heading(m.yaw)],
  },
  vehicle_gps_position: {
    gps: (m) => m.fix_type >= 3 && (m.latitude_deg === undefined
      ? [m.lat * 1e-7, m.lon * 1e-7, m.alt * 1e-3]
      : [m.latitude_deg, m.longitude_deg, m.altitude_msl_m]),
  },
};

// From north, east, down and forward, right, down, w first and not negative.
function product([a, b, c, d], [e, f, g, h]) {
  return [a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g,
          a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e];
}
function turned(q) {
  const h = Math.SQRT1_2;
  const turn = product(product([0, h, h, 0], q), [0, 1, 0, 0]);
  const size = Math.hypot(...turn) * (turn[0] < 0 ? -1 : 1);
  return turn.map((v) => v / size);
}

async function main() {
  const [file, infoFile] = process.argv.slice(2);
  const ulog = new ULog(new FileReader(file));
  await ulog.open();
  const info = JSON.parse(readFileSync(infoFile));
  const counts = {}, sums = {}, chosen = {};
  for (const [id, count] of ulog.dataMessageCounts()) {
    const topic = ulog.subscriptions.get(id);
    counts[topic.name + (topic.multiId ? "#" + topic.multiId : "")] = count;
  }
  for await (const message of ulog.readMessages({ includeLogs: false })) {
    if (message.type !== "D".charCodeAt(0)) continue;
    const topic = ulog.subscriptions.get(message.msgId);
    chosen[topic.name] ??= topic.multiId;
    if (chosen[topic.name] !== topic.multiId) continue;
    for (const [series, read] of Object.entries(SERIES[topic.name] ?? {})) {
      if (info.series[series]?.source !== topic.name) continue;
      const value = read(message.value);
      if (!value || !value.every(Number.isFinite)) continue;
      const t = Number(message.value.timestamp_sample || message.value.timestamp) / 1e6;
      const sum = (sums[series] ??= { n: 0, times: new Set(), mean: value.map(() => 0),
                                      least: value.map(() => Infinity), most: value.map(() => -Infinity) });
      if (sum.times.has(t)) continue;
      sum.times.add(t);
      sum.n++;
      value.forEach((v, i) => {
        sum.mean[i] += v;
        sum.least[i] = Math.min(sum.least[i], v);
        sum.most[i] = Math.max(sum.most[i], v);
      });
    }
  }
  const problems = [];
  for (const name of new Set([...Object.keys(counts), ...Object.keys(info.records)]))
    if (counts[name] !== info.records[name])
      problems.push(`${name}: ${info.records[name]} messages, not ${counts[name]}`);
  let compared = 0;
  for (const [series, sum] of Object.entries(sums)) {
    const own = info.series[series];
    if (own.samples !== sum.n) problems.push(`${series}: ${own.samples} samples, not ${sum.n}`);
    sum.mean.forEach((mean, i) => {
      const size = Math.max(1, Math.abs(sum.least[i]), Math.abs(sum.most[i]));
      for (const [name, value] of [["mean", mean / sum.n], ["least", sum.least[i]], ["most", sum.most[i]]]) {
        compared++;
        if (!(Math.abs(own[name][i] - value) <= 1e-9 * size))
          problems.push(`${series}[${i}]: ${name} ${own[name][i]}, not ${value}`);
      }
    });
  }
  if (compared < 20) problems.push(`only ${compared} values were compared`);
  if (problems.length) throw new Error(problems.slice(0, 5).join("; "));
  console.log(`${Object.keys(counts).length} topics, ${compared} values of ${Object.keys(sums).length} series`);
}

main().catch((error) => {
  console.log(error.message);
  process.exit(1);
});
