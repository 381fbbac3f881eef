"""Each way in which a fit can deceive, as a criterion with a sentence."""
