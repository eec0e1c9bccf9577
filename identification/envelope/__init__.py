"""From flights with multistep inputs to linear models of a helicopter over its flight envelope (seed 003)."""
