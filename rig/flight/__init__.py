"""A law flown by a board: a client, an emulated chip or a simulated plant in, outputs, live rows and times out."""
