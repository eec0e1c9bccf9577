"""Linear models of a helicopter over its flight envelope, from flights with multistep inputs (seed 003)."""
