-- SPDX-License-Identifier: Apache-2.0
local terms = require "film_terms"
return terms.film(terms.shipped)
