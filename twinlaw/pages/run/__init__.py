"""Design, verification, image and flight go in, the report of `twinlaw run` and the rows that the chain's verbs print come out."""
