local terms = require "film_terms"
return terms.film(terms.written)
