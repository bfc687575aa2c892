// SPDX-License-Identifier: Apache-2.0
// node gltf.js FILE.glb: exit status 1, and each finding, if the validator of Khronos has an error
// or a warning.
const { readFileSync } = require("fs");
const { validateBytes } = require("gltf-validator");

validateBytes(new Uint8Array(readFileSync(process.argv[2]))).then(({ issues }) => {
  for (const finding of issues.messages) {
    if (finding.severity < 2) console.log(`${finding.code} ${finding.pointer}: ${finding.message}`);
  }
  process.exit(issues.numErrors + issues.numWarnings > 0 ? 1 : 0);
});
