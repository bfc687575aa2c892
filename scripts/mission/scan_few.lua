-- SPDX-License-Identifier: Apache-2.0
local GIVEN = 1 / 3        -- share of the candidates that starts are at most
local GOLDEN = 0.6180339887498949

-- The first `needed` of the starts, and as many of the rest, evenly, as leave most of the
-- candidates to be grown from them. What flies to and fro repeats itself: multiples of the golden
-- section keep all its headings.
return function(starts, needed, most)
  if #starts <= GIVEN * most then return starts end
  local share = (GIVEN * most - needed) / (#starts - needed)
  local kept = {}
  for k, view in ipairs(starts) do
    if k <= needed or k * GOLDEN % 1 < share then kept[#kept + 1] = view end
  end
  return kept
end
