-- SPDX-License-Identifier: Apache-2.0
-- The checks of a certificate, as `run:certify` gives them.
local M = {}

-- Whether a check is one that fails its certificate.
function M.fails(check) return check.required and not check.skipped and not check.pass end

return M
